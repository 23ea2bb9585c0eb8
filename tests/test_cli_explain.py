"""What a run leaves out, from outside: said before it, asked of check, and undone."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.builders.command import Somo
from tests.builders.scenes import DEFINITIONS

pytest.importorskip("pybullet")


@pytest.fixture
def here(tmp_path: Path) -> Path:
    for name in ("finger.yaml", "scene.yaml", "press_scene.yaml"):
        shutil.copy(DEFINITIONS / name, tmp_path)
    return tmp_path


@pytest.mark.moderate
def test_a_run_says_what_it_leaves_out_and_keeps_it_beside_its_result(
    somo: Somo, here: Path
) -> None:
    ended = somo("run", "scene.yaml", "--steps", "10", "--explain", "-o", "-", "-q", cwd=here)
    assert ended.returncode == 0
    assert ended.stderr.startswith("left out  collision shapes: one manipulator, no ground")
    assert ended.stdout.startswith("time_s,")
    somo("run", "scene.yaml", "--steps", "10", "-q", cwd=here)
    reported = json.loads((here / "scene.meta.json").read_text("utf-8"))["plan"]
    assert [
        f"{one['what']}: {one['why']}" + (f"; saves {one['saves']}" if one["saves"] else "")
        for one in reported
    ] == [line[10:] for line in ended.stderr.splitlines()]
    assert "motor rows of joints: no dry friction; saves 10 rows in every step" in ended.stderr


@pytest.mark.moderate
@pytest.mark.parametrize("scene", ["scene.yaml", "press_scene.yaml"])
def test_keeping_everything_changes_no_byte(somo: Somo, here: Path, scene: str) -> None:
    command = ("run", scene, "--steps", "40", "-o", "-", "-q")
    lean, whole = (somo(*command, *more, cwd=here) for more in ((), ("--keep-everything",)))
    assert lean.stdout == whole.stdout


@pytest.mark.moderate
def test_what_is_kept_on_request_is_reported_as_kept(somo: Somo, here: Path) -> None:
    command = ("run", "scene.yaml", "--steps", "1", "--verbose", "--keep-everything", "-q")
    ended = somo(*command, cwd=here)
    assert "kept      motor rows of joints: asked for, though no dry friction\n" in ended.stderr
    reported = json.loads((here / "scene.meta.json").read_text("utf-8"))["plan"]
    assert {
        "what": "motor rows of joints",
        "kept": True,
        "why": "asked for, though no dry friction",
        "saves": None,
    } in reported


@pytest.mark.moderate
def test_check_prints_the_plan(somo: Somo, here: Path) -> None:
    ended = somo("check", "press_scene.yaml", "--plan", cwd=here)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "kept      collision shapes: 1 manipulator, the ground can touch\n" in ended.stdout
    ended = somo("check", "press_scene.yaml", "--plan", "--json", cwd=here)
    found = json.loads(ended.stdout)
    assert found["findings"] == []
    assert found["plan"][0]["kept"] is True


def test_errors_are_reported_instead_of_a_plan(somo: Somo, here: Path) -> None:
    (here / "bad.yaml").write_text("manipulators: []\n", "utf-8")
    ended = somo("check", "bad.yaml", "--plan", cwd=here)
    assert ended.returncode == 1
    assert ended.stdout == ""
    assert "bad.yaml:1:1: error:" in ended.stderr


@pytest.mark.parametrize("more", [("scene.yaml",), ("--numerics",)])
def test_a_plan_is_of_one_scene_and_by_itself(
    somo: Somo, here: Path, more: tuple[str, ...]
) -> None:
    assert somo("check", "press_scene.yaml", "--plan", *more, cwd=here).returncode == 2
