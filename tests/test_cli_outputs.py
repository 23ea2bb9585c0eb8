"""Strangers' files: none chooses what is replaced, none takes for ever or leaves floats' range."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.builders.command import Somo

DEFINITIONS = Path(__file__).parents[1] / "definitions"


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with the shipped finger and its scene."""
    for name in ("finger.yaml", "scene.yaml"):
        shutil.copy(DEFINITIONS / name, tmp_path)
    return tmp_path


def named(here: Path, name: str) -> None:
    """Have the definition name its own URDF."""
    text = (here / "finger.yaml").read_text("utf-8")
    (here / "stranger.yaml").write_text(f"urdf_filename: {name!r}\n{text}", "utf-8")


@pytest.mark.moderate
@pytest.mark.parametrize("name", ["Makefile", "notes.urdf"])
def test_a_name_from_a_file_replaces_nothing_that_is_not_ours(
    somo: Somo, here: Path, name: str
) -> None:
    (here / name).write_text("all: work of years\n", "utf-8")
    named(here, name)
    done = somo("build", "stranger.yaml")
    assert (done.returncode, done.stdout) == (2, "")
    assert "is a file that somo did not write" in " ".join(done.stderr.split())
    assert (here / name).read_text("utf-8") == "all: work of years\n"
    # named on the command line it is the user's will
    assert somo("build", "stranger.yaml", "-o", name).returncode == 0
    assert (here / name).read_text("utf-8").startswith("<?xml")
    # and what was built once is built again
    assert somo("build", "stranger.yaml").returncode == 0


@pytest.mark.moderate
def test_a_link_to_a_foreign_file_is_not_followed(somo: Somo, here: Path) -> None:
    (here / "secret").write_text("of value", "utf-8")
    (here / "a.urdf").symlink_to("secret")
    (here / "b.urdf").symlink_to("nowhere")
    for name in ("a.urdf", "b.urdf"):
        named(here, name)
        assert somo("build", "stranger.yaml").returncode == 2
    assert (here / "secret").read_text("utf-8") == "of value"
    assert not (here / "nowhere").exists()


@pytest.mark.parametrize("name", ["-", ".bashrc", "a\nb", "folder/.profile", "-o"])
def test_a_name_that_is_none_is_an_error_of_the_file(somo: Somo, here: Path, name: str) -> None:
    text = (here / "finger.yaml").read_text("utf-8")
    quoted = name.replace("\n", "\\n")
    (here / "stranger.yaml").write_text(f'urdf_filename: "{quoted}"\n{text}', "utf-8")
    before = sorted(path.name for path in here.iterdir())
    done = somo("build", "stranger.yaml")
    assert (done.returncode, done.stdout) == (3, "")
    assert "stranger.yaml:1:16: error: urdf_filename" in done.stderr
    assert "is not the name of a file" in done.stderr
    assert sorted(path.name for path in here.iterdir()) == before


@pytest.mark.moderate
def test_the_metadata_of_a_run_does_not_replace_its_scene(somo: Somo, here: Path) -> None:
    pytest.importorskip("pybullet")
    (here / "b.meta.json").write_text('{"manipulators": [{"definition": "finger.yaml"}]}', "utf-8")
    scene = (here / "b.meta.json").read_bytes()
    done = somo("run", "b.meta.json", "--steps", "3", "-o", "b.csv")
    assert (done.returncode, done.stdout) == (2, "")
    assert "b.meta.json is one of the files that are read" in " ".join(done.stderr.split())
    assert (here / "b.meta.json").read_bytes() == scene
    (here / "c.csv.partial").write_bytes(scene)
    done = somo("run", "c.csv.partial", "--steps", "3", "-o", "c.csv")
    assert done.returncode == 2
    assert (here / "c.csv.partial").read_bytes() == scene


@pytest.mark.parametrize(
    "arguments",
    [
        ("report", "tiny_scene.yaml"),
        ("render", "tiny_scene.yaml", "--at", "0.1"),
        ("render", "tiny_scene.yaml", "--until", "0.1", "-o", "a.gif"),
    ],
)
def test_a_time_of_too_many_steps_is_said_at_once(
    somo: Somo, here: Path, arguments: tuple[str, ...]
) -> None:
    if arguments[-1] == "a.gif":
        pytest.importorskip("imageio_ffmpeg")
    text = "time_step: 1e-12\nmanipulators:\n  - definition: finger.yaml\n"
    (here / "tiny_scene.yaml").write_text(text, "utf-8")
    done = somo(*arguments, timeout=20)
    assert (done.returncode, done.stdout) == (2, "")
    assert "time steps, more than 1e+08" in " ".join(done.stderr.split())


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("command", "text", "place"),
    [
        (
            ("calibrate", "torque", "--length", "0.1", "--joints", "5", "--data", "data.csv"),
            "pressure_pa,force_n\n0,0\n20000,0.14\n50000,0.34\n-1e308,-0.69\n",
            "data.csv:5:1",
        ),
        (
            ("calibrate", "damping", "finger.yaml", "--ring-down", "data.csv"),
            "time_s,tip.x_m\n0,0.01\n0.1,-0.005\n0.2,1e21\n0.3,-0.001\n",
            "data.csv:4:5",
        ),
    ],
)
def test_a_number_of_a_csv_has_the_bounds_of_all_numbers(
    somo: Somo, here: Path, command: tuple[str, ...], text: str, place: str
) -> None:
    (here / "data.csv").write_text(text, "utf-8")
    done = somo(*command)
    assert (done.returncode, done.stdout) == (3, "")
    assert f"{place}: error: " in done.stderr
    assert "no number may be larger than 1e+20" in done.stderr


@pytest.mark.moderate
def test_measurements_too_small_for_their_squares_are_refused(somo: Somo, here: Path) -> None:
    text = "pressure_pa,force_n\n0,0\n1e-200,1\n2e-200,2\n-1e-200,-1\n"
    (here / "data.csv").write_text(text, "utf-8")
    done = somo("calibrate", "torque", "--length", "0.1", "--joints", "5", "--data", "data.csv")
    assert (done.returncode, done.stdout) == (3, "")
    assert "data.csv:1:1: error: the numbers of 'pressure_pa' are too small" in done.stderr


@pytest.mark.moderate
def test_a_scale_far_from_one_is_refused(somo: Somo, here: Path) -> None:
    for scale in ("1e-160", "1e-7", "1e7", "0", "nan"):
        done = somo("build", "finger.yaml", "--scale", scale, "-o", "-")
        assert (done.returncode, done.stdout) == (2, "")
