"""Pictures and films, from outside: files, streams, exit codes."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")

SMALL = ("--size", "160x120")
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with the shipped scenes in a folder of their own."""
    shutil.copytree(DEFINITIONS, tmp_path / "definitions")
    return tmp_path


def left(folder: Path) -> set[str]:
    """Return what is there beside the scenes, hidden files included."""
    return {path.name for path in folder.iterdir()} - {"definitions"}


@pytest.mark.moderate
def test_a_scene_is_drawn_at_its_start_unless_a_time_is_given(somo: Somo, here: Path) -> None:
    ended = somo("render", "definitions/lift_scene.yaml", *SMALL)
    assert (ended.returncode, ended.stdout) == (0, "")
    assert ended.stderr == "lift_scene.png: 160 x 120 pixels, at 0 s, squares of 0.02 m\n"
    assert (here / "lift_scene.png").read_bytes().startswith(PNG)
    later = somo("render", "definitions/lift_scene.yaml", *SMALL, "--at", "0.0204", "-o", "b.PNG")
    assert later.stderr == "b.PNG: 160 x 120 pixels, at 0.02 s, squares of 0.02 m\n"
    assert left(here) == {"lift_scene.png", "b.PNG"}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["lift_scene", "starfish_scene", "snake_scene", "finger"])
def test_a_recording_gives_the_picture_of_its_scene_byte_for_byte(
    somo: Somo, here: Path, name: str
) -> None:
    source = f"definitions/{name}.yaml"
    end = "0.2"
    drawn = somo("render", source, *SMALL, "--at", end, "-q", "-o", "scene.png")
    assert (drawn.returncode, drawn.stderr) == (0, "")
    (here / "elsewhere").mkdir()
    run = somo("run", source, "--steps", "240", "--every", "20", "-q", "-o", "elsewhere/rows.csv")
    assert (run.returncode, run.stderr) == (0, "")
    meta = json.loads((here / "elsewhere/rows.meta.json").read_text("utf-8"))
    assert meta["scene"] == f"../definitions/{name}.yaml"
    drawn = somo("render", "../rows.csv", *SMALL, "--at", end, "-o", "csv.png", cwd=_moved(here))
    assert drawn.returncode == 0, drawn.stderr
    pictures = [(here / one).read_bytes() for one in ("scene.png", "deep/csv.png")]
    assert pictures[0] == pictures[1]


def _moved(here: Path) -> Path:
    """Put the rows two folders further, scenes with them; the working directory beside."""
    (here / "elsewhere").rename(here / "deep")
    (here / "deep/rows.csv").rename(here / "rows.csv")
    meta = json.loads((here / "deep/rows.meta.json").read_text("utf-8"))
    meta["scene"] = meta["scene"].removeprefix("../")
    (here / "rows.meta.json").write_text(json.dumps(meta), "utf-8")
    return here / "deep"


@pytest.mark.slow
def test_what_overrode_the_scene_of_a_recording_overrides_it_again(somo: Somo, here: Path) -> None:
    flat = ("--set", "objects[0].dimensions=[0.04, 0.04, 0.005]")
    source, options = "definitions/lift_scene.yaml", (*SMALL, "-q", "-o")
    somo("render", source, *flat, *options, "scene.png")
    somo("run", source, "--steps", "0", *flat, "-q", "-o", "rows.csv")
    ended = somo("render", "rows.csv", *options, "csv.png")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert (here / "scene.png").read_bytes() == (here / "csv.png").read_bytes()
    somo("render", "rows.csv", "--set", "objects[0].material_color=[1,0,0,1]", *options, "red.png")
    assert (here / "red.png").read_bytes() != (here / "csv.png").read_bytes()


@pytest.mark.moderate
def test_a_scene_that_has_changed_since_gives_a_warning(somo: Somo, here: Path) -> None:
    somo("run", "definitions/scene.yaml", "--steps", "20", "-q", "-o", "rows.csv")
    finger = here / "definitions/finger.yaml"
    finger.write_text(finger.read_text("utf-8") + "# longer\n", "utf-8")
    ended = somo("render", "rows.csv", *SMALL, "-q")
    assert ended.returncode == 0
    assert ended.stderr.startswith(
        "definitions/finger.yaml:1:1: warning: this file has changed since the run was recorded\n"
    )
    assert "scene.yaml" not in ended.stderr


@pytest.mark.slow
def test_what_a_recording_lacks_is_simulated_again(somo: Somo, here: Path) -> None:
    scene, gravity = "definitions/in_hand_scene.yaml", ("--set", "gravity=[0, 0, -9]")
    run = ("run", scene, *gravity, "--time-step", "0.002", "--duration", "0.4", "-q")
    assert somo(*run, "-o", "rows.csv").returncode == 0
    still = (*SMALL, "-q", "--at", "0.3", "-o")
    ended = somo("render", "rows.csv", "--simulate", *still, "again.png")
    assert (ended.returncode, ended.stderr) == (0, "")
    options = ("--record", "*.angle_rad", "--record", "*.pose.*", "--every", "10")
    assert somo(*run, *options, "-o", "all.csv").returncode == 0
    somo("render", "all.csv", *still, "whole.png")
    assert (here / "again.png").read_bytes() == (here / "whole.png").read_bytes()
    table = (here / "rows.csv").read_text("utf-8").splitlines()
    time, first, rest = table[2].split(",", 2)
    table[2] = ",".join((time, str(float(first) + 0.1), rest))
    (here / "rows.csv").write_text("\n".join(table) + "\n", "utf-8")
    ended = somo("render", "rows.csv", "--simulate", *still, "again.png")
    assert ended.returncode == 0
    assert ended.stderr.startswith(
        "somo: warning: this simulation is not the one that was recorded: "
        "finger_1.actuator_0_joint_01.angle_rad differs by "
    )


@pytest.mark.moderate
def test_missing_columns_are_reported_with_the_options_that_record_them(
    somo: Somo, here: Path
) -> None:
    run = ("run", "definitions/turn_scene.yaml", "--steps", "40", "--every", "10", "-q")
    somo(*run, "-o", "rows.csv")
    ended = somo("render", "rows.csv", *SMALL)
    assert ended.returncode == 3
    first, *_, hint = ended.stderr.splitlines()
    assert first == (
        "rows.csv:1:1: error: it has no pose of bar, such as 'bar.pose.z_m', "
        "so the configuration is unknown"
    )
    start, _, command = hint.partition(", or record it: ")
    assert start == "  hint: simulate it again with --simulate"
    assert command == (
        "somo run definitions/turn_scene.yaml --duration 0.04 --time-step 0.001 "
        "--record '*.angle_rad' --record '*.pose.*' -o rows.csv"
    )
    assert somo(*shlex.split(command)[1:]).returncode == 0
    assert somo("render", "rows.csv", *SMALL).returncode == 0


@pytest.mark.slow
def test_a_recording_whose_scene_is_unknown(somo: Somo, here: Path) -> None:
    somo("run", "definitions/scene.yaml", "--steps", "20", "-q", "-o", "rows.csv")
    (here / "rows.meta.json").unlink()
    ended = somo("render", "rows.csv", *SMALL)
    assert ended.returncode == 3
    assert ended.stderr.startswith("rows.csv:1:1: error: there is no rows.meta.json beside it")
    named = ("--scene", "definitions/scene.yaml")
    assert somo("render", "rows.csv", *named, *SMALL).returncode == 0
    for content in ("[]", "{}", '{"scene": 3}', '{"scene": "x.yaml", "overrides": 3}'):
        (here / "rows.meta.json").write_text(content, "utf-8")
        ended = somo("render", "rows.csv", *SMALL)
        message = "rows.meta.json:1:1: error: this does not name the scene of the recording"
        assert (ended.returncode, ended.stderr.splitlines()[0]) == (3, message)
    (here / "rows.meta.json").write_text('{"scene":\n  x}', "utf-8")
    ended = somo("render", "rows.csv", *SMALL)
    message = "rows.meta.json:2:3: error: this is not JSON: Expecting value"
    assert (ended.returncode, ended.stderr.splitlines()[0]) == (3, message)
    (here / "rows.meta.json").write_text('{"scene": "gone.yaml"}', "utf-8")
    ended = somo("render", "rows.csv", *SMALL)
    message = "rows.meta.json:1:1: error: the scene of this recording, gone.yaml, does not exist"
    assert (ended.returncode, ended.stderr.startswith(message)) == (3, True)


@pytest.mark.moderate
def test_a_recording_that_cannot_be_read(somo: Somo, here: Path) -> None:
    somo("run", "definitions/scene.yaml", "--steps", "20", "-q", "-o", "rows.csv")
    rows = here / "rows.csv"
    rows.write_text(rows.read_text("utf-8") + "0.03,oops\n", "utf-8")
    ended = somo("render", "rows.csv", *SMALL)
    assert ended.returncode == 3
    assert ended.stderr.startswith("rows.csv:5:1: error: 2 cells, but the header names ")
    assert somo("render", "none.csv").returncode == 5


WRONG = {
    "--output": [("-o", "a.jpg"), ("-o", "a"), ("-o", "-")],
    "--size": [("--size", "0x9"), ("--size", "100"), ("--size", "99999x100"), ("--size", "axb")],
    "--camera": [("--camera", "back"), ("--camera", "1,2,3,4"), ("--camera", "0,91")],
    "--target": [("--target", "1,2"), ("--target", "1,2,nan")],
    "--at": [("--at", "-1"), ("--at", "nan"), ("-o", "a.gif", "--at", "1")],
    "--every": [("--every", "0.1"), ("-o", "a.gif", "--every", "0", "--until", "1")],
    "--until": [("--until", "1"), ("-o", "a.gif")],
    "--from": [("--from", "1"), ("-o", "a.gif", "--from", "0.2", "--until", "0.1")],
    "--speed": [("--speed", "0")],
    "--steps": [("--steps", "3", "--at", "1")],
    "--scene": [("--scene", "a.yaml")],
}


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("option", "given"), [(option, one) for option, own in WRONG.items() for one in own]
)
def test_wrong_usage_is_reported_and_nothing_written(
    somo: Somo, here: Path, fake_encoder: dict[str, str], option: str, given: tuple[str, ...]
) -> None:
    ended = somo("render", "definitions/scene.yaml", *given, env=fake_encoder)
    assert ended.returncode == 2, ended.stderr
    assert f"Invalid value for '{option}'" in ended.stderr
    assert "Traceback" not in ended.stderr
    assert left(here) == {"fake"}


@pytest.fixture
def fake_encoder(here: Path, environment: dict[str, str]) -> dict[str, str]:
    """An environment in which an encoder seems to be there, whatever is installed."""
    (here / "fake").mkdir()
    (here / "fake/imageio_ffmpeg.py").write_text("def get_ffmpeg_exe():\n    pass\n", "utf-8")
    return {"PYTHONPATH": os.pathsep.join([str(here / "fake"), environment["PYTHONPATH"]])}


@pytest.mark.moderate
def test_a_time_beyond_the_end_is_wrong_usage(somo: Somo, here: Path) -> None:
    somo("run", "definitions/scene.yaml", "--steps", "20", "-q", "-o", "rows.csv")
    ended = somo("render", "rows.csv", "--at", "3", *SMALL)
    assert ended.returncode == 2
    assert "'--at': 3 s is after the end, 0.02 s\n" in ended.stderr
    stop = ("--set", "stop=[{time: 0.01}]")
    ended = somo("render", "definitions/scene.yaml", "--at", "3", *stop, *SMALL)
    assert ended.returncode == 2
    said = "'--at': 3 s is after the end, 0.01 s, by stop[0]: the time is 0.01 s\n"
    assert said in ended.stderr


@pytest.mark.moderate
def test_an_output_that_cannot_be_written_is_reported_before_the_work(
    somo: Somo, here: Path
) -> None:
    started = time.monotonic()
    ended = somo("render", "definitions/hand_scene.yaml", "--at", "1000", "-o", "none/a.png")
    assert (ended.returncode, ended.stderr) == (5, "somo: none/a.png: No such file or directory\n")
    assert time.monotonic() - started < 20
    source = "definitions/scene.yaml"
    (here / "a.png").symlink_to(here / source)
    ended = somo("render", source, "-o", "a.png")
    assert (ended.returncode, "is one of the files that are read" in ended.stderr) == (2, True)


@pytest.mark.moderate
def test_a_film_without_an_encoder_says_what_to_install(
    somo: Somo, here: Path, environment: dict[str, str]
) -> None:
    (here / "none").mkdir()
    (here / "none/imageio_ffmpeg.py").write_text("raise ImportError\n", "utf-8")
    without = {"PYTHONPATH": os.pathsep.join([str(here / "none"), environment["PYTHONPATH"]])}
    ended = somo("render", "definitions/scene.yaml", "--steps", "9", "-o", "a.mp4", env=without)
    said = "somo: films need imageio-ffmpeg: pip install 'somo-cli[film]'\n"
    assert (ended.returncode, ended.stderr) == (5, said)
    assert left(here) == {"none"}
    assert somo("render", "definitions/scene.yaml", *SMALL, "-q", env=without).returncode == 0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["mp4", "gif"])
def test_a_film_of_a_scene_and_of_its_recording(somo: Somo, here: Path, kind: str) -> None:
    pytest.importorskip("imageio_ffmpeg")
    source, output = "definitions/lift_scene.yaml", f"scene.{kind}"
    ended = somo("render", source, *SMALL, "--until", "0.4", "-o", output)
    said = "11 pictures from 0 s to 0.4 s, 25 a second, 160 x 120 pixels, squares of 0.05 m\n"
    assert (ended.returncode, ended.stderr) == (0, f"{output}: {said}")
    somo("run", source, "--steps", "400", "-q", "-o", "rows.csv")
    assert somo("render", "rows.csv", *SMALL, "-q", "-o", f"csv.{kind}").returncode == 0
    assert (here / output).read_bytes() == (here / f"csv.{kind}").read_bytes()
    slow = ("--speed", "0.1", "--from", "0.3", "-o", f"slow.{kind}")
    ended = somo("render", "rows.csv", *SMALL, *slow)
    assert "26 pictures from 0.3 s to 0.4 s, 25 a second" in ended.stderr


@pytest.mark.slow
def test_a_film_goes_to_the_end_of_a_scene_that_stops(somo: Somo, here: Path) -> None:
    pytest.importorskip("imageio_ffmpeg")
    stop = ("--set", "stop=[{time: 0.1}]")
    film = ("render", "definitions/scene.yaml", *SMALL, *stop, "-o", "a.gif")
    for end in ((), ("--until", "5")):
        ended = somo(*film, *end)
        assert ended.returncode == 0, ended.stderr
        assert "3 pictures from 0 s to 0.08 s" in ended.stderr
        said = "the film ends at 0.1 s, by stop[0]: the time is 0.1 s\n"
        assert (said in ended.stderr) == bool(end)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals are others there")
def test_an_interrupted_film_leaves_nothing_behind(here: Path, environment: dict[str, str]) -> None:
    pytest.importorskip("imageio_ffmpeg")
    (here / "temporary").mkdir()
    started = subprocess.Popen(
        [
            *(sys.executable, "-m", "somo_cli", "render", "definitions/scene.yaml"),
            *("--until", "40", "-o", "a.mp4", *SMALL),
        ],
        cwd=here,
        env=environment | {"TMPDIR": str(here / "temporary")},
        stderr=subprocess.PIPE,
        text=True,
    )
    patience = time.monotonic() + 60
    while not list((here / "temporary").glob("somo-*/film.mp4")) and time.monotonic() < patience:
        time.sleep(0.1)
    started.send_signal(signal.SIGINT)
    _, said = started.communicate(timeout=60)
    assert (started.returncode, said) == (130, "somo: interrupted\n")
    assert left(here) == {"temporary"}
    assert list((here / "temporary").iterdir()) == []
