"""How long a scene is simulated: --steps, --duration, or the scene's own duration."""

from __future__ import annotations

from pathlib import Path

import pytest

import somo_cli
from somo_cli.scene.duration import is_whole, steps_of
from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")

SCENE = str(DEFINITIONS / "scene.yaml")  # a row every 10 ms


@pytest.mark.parametrize(
    "options", [("--steps", "40"), ("--steps", "4e1"), ("--duration", "0.04")], ids=" ".join
)
def test_steps_and_seconds_say_the_same(somo: Somo, options: tuple[str, ...]) -> None:
    ended = somo("run", SCENE, *options, "-q", "-o", "-")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout.splitlines()[-1].startswith("0.04,")


def test_the_scene_says_how_long_unless_the_command_does(somo: Somo) -> None:
    own = ("--set", "duration=0.03")
    assert somo("run", SCENE, *own, "-q", "-o", "-").stdout.splitlines()[-1].startswith("0.03,")
    shorter = somo("run", SCENE, *own, "--steps", "20", "-q", "-o", "-").stdout
    assert shorter.splitlines()[-1].startswith("0.02,")


def test_a_time_between_two_steps_is_rounded_and_said(somo: Somo) -> None:
    ended = somo("run", SCENE, "--duration", "0.0307", "-q", "-o", "-")
    assert ended.returncode == 0
    assert ended.stderr == (
        "somo: 0.0307 s is not a whole number of steps of 0.001 s: simulating 31 steps, 0.031 s\n"
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "give --duration in seconds, or --steps: the scene has no duration of its own"),
        (("--steps", "1", "--duration", "1"), "it excludes --steps"),
        (("--steps", "1.5"), "'1.5' is not a whole number from 0 on, such as 2000 or 2e3"),
        (("--steps", "-1"), "'-1' is not a whole number"),
        (("--steps", "many"), "'many' is not a whole number"),
        (("--steps", "nan"), "'nan' is not a whole number"),
        (("--duration", "0"), "0.0 is not greater than 0 and at most 1e+06"),
        (("--duration", "nan"), "nan is not greater than 0"),
    ],
)
def test_a_wrong_time_is_wrong_usage(
    somo: Somo, tmp_path: Path, options: tuple[str, ...], message: str
) -> None:
    ended = somo("run", SCENE, *options, cwd=tmp_path)
    assert ended.returncode == 2
    assert message in " ".join(ended.stderr.split())
    assert not list(tmp_path.iterdir())


def test_a_duration_is_checked_in_a_scene(somo: Somo) -> None:
    ended = somo("run", SCENE, "--set", "duration=-1")
    assert ended.returncode == 3
    assert "duration" in ended.stderr


def test_the_api_takes_seconds_too() -> None:
    document = somo_cli.load(SCENE)
    by_steps, by_time = somo_cli.simulate(document, 40), somo_cli.simulate(document, duration=0.04)
    assert by_time.to_csv() == by_steps.to_csv()
    timed = somo_cli.load(SCENE, sets=["duration=0.04"])
    assert somo_cli.simulate(timed).to_csv() == by_steps.to_csv()
    with pytest.raises(ValueError, match="no duration of its own"):
        somo_cli.simulate(document)
    with pytest.raises(ValueError, match="not both"):
        somo_cli.simulate(document, 1, duration=1.0)


@pytest.mark.parametrize(
    ("duration", "step", "steps", "whole"),
    [
        (2.5, 1e-3, 2500, True),
        (0.3, 0.1, 3, True),
        (1.0, 3e-4, 3333, False),
        (1e6, 1e-3, 10**9, True),
    ],
)
def test_times_are_whole_in_floating_point(
    duration: float, step: float, steps: int, whole: bool
) -> None:
    assert (steps_of(duration, step), is_whole(duration, step)) == (steps, whole)


@pytest.mark.parametrize("command", ["run", "report", "render", "calibrate", "sweep"])
def test_a_short_h_asks_for_help(somo: Somo, command: str) -> None:
    assert somo(command, "-h").stdout == somo(command, "--help").stdout != ""


def test_the_list_of_commands_is_not_cut_off(somo: Somo) -> None:
    for arguments in (("--help",), ("calibrate", "--help")):
        listed = somo(*arguments, env={"COLUMNS": "80"}).stdout
        assert "..." not in listed.partition("Commands:")[2]


def test_films_take_the_duration_of_their_scene(somo: Somo, tmp_path: Path) -> None:
    film = tmp_path / "film.gif"
    size = ("--size", "64x48", "-q", "--every", "0.05")
    ended = somo("render", SCENE, "--duration", "0.1", *size, "-o", str(film))
    assert (ended.returncode, ended.stderr) == (0, "")
    by_until = tmp_path / "until.gif"
    somo("render", SCENE, "--until", "0.1", *size, "-o", str(by_until))
    assert film.read_bytes() == by_until.read_bytes()


def test_a_report_counts_steps_of_its_scene(somo: Somo) -> None:
    far_apart = ("report", SCENE, "--time-steps", "0.01,0.02")
    said = [somo(*far_apart, *time).stderr for time in (("--steps", "40"), ("--duration", "0.04"))]
    assert said[0] == said[1]
    assert "2 times in 0.04 s" in " ".join(said[0].split())
    both = somo(*far_apart, "--steps", "40", "--duration", "0.04")
    assert (both.returncode, both.stdout) == (2, "")
    assert "it excludes --steps" in " ".join(both.stderr.split())
