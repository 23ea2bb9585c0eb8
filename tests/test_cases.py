"""Whole documents in tests/cases/: what `somo` says of each, to the letter; a case is a file.

`invalid/x.yaml` must be refused with the text of `invalid/x.txt`, `warnings/x.yaml` pass with it,
`valid/x.yaml` pass without a word. Names that start with `scene_` are scenes. After a change of
words, `pytest tests/test_cases.py --rewrite-golden` writes the texts anew: the diff is the review.
"""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from somo_cli import cli
from tests.builders.command import Somo

CASES = Path(__file__).parent / "cases"


class Ended(NamedTuple):
    code: object
    out: str
    err: str


Call = Callable[..., Ended]


def documents(folder: str) -> list[str]:
    return sorted(p.name for p in (CASES / folder).iterdir() if p.suffix in (".yaml", ".json"))


def expected(folder: str, name: str) -> str:
    return (CASES / folder / name).with_suffix(".txt").read_text("utf-8")


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the cases, so that whatever a command leaves behind is seen and goes away."""
    return Path(shutil.copytree(CASES, tmp_path_factory.mktemp("copy") / "cases"))


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Call:
    """Run the command in this process, as a machine without the engine would."""
    monkeypatch.setitem(sys.modules, "pybullet", None)

    def run(*arguments: str) -> Ended:
        monkeypatch.setattr(sys, "argv", ["somo", *arguments])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        return Ended(caught.value.code, *capsys.readouterr())

    return run


def tree(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.moderate
@pytest.mark.parametrize("name", documents("invalid"))
def test_an_invalid_document(
    name: str, call: Call, copy: Path, monkeypatch: pytest.MonkeyPatch, rewrite_golden: bool
) -> None:
    folder = copy / "invalid"
    monkeypatch.chdir(folder)
    before = tree(folder)
    checked = call("check", name)
    if rewrite_golden:
        (CASES / "invalid" / name).with_suffix(".txt").write_bytes(checked.err.encode())
    assert checked == (1, "", expected("invalid", name))
    if name.startswith("trajectory"):
        return  # it neither runs nor builds, see below
    assert call("run", name, "--steps", "0") == (3, "", checked.err)
    if not name.startswith("scene_"):
        assert call("build", name) == (3, "", checked.err)
    assert tree(folder) == before


@pytest.mark.parametrize("name", documents("valid"))
def test_a_valid_document(
    name: str, call: Call, copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(copy / "valid")
    assert call("check", name) == (0, "", "")
    if not name.startswith(("scene_", "trajectory")):
        assert call("build", name, "--quiet", "--output", "../built.urdf") == (0, "", "")


def test_a_trajectory_neither_runs_nor_builds(
    call: Call, copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(copy / "valid")
    for command in (("build",), ("run", "--steps", "0"), ("calibrate", "stiffness")):
        ended = call(*command, "trajectory.yaml")
        assert (ended.code, ended.out) == (3, "")
        assert ended.err.splitlines()[0] == (
            "trajectory.yaml:4:1: error: this is a trajectory, not a manipulator definition or a "
            "scene"
        )


@pytest.mark.parametrize("name", documents("warnings"))
def test_a_document_with_warnings(
    name: str, call: Call, copy: Path, monkeypatch: pytest.MonkeyPatch, rewrite_golden: bool
) -> None:
    monkeypatch.chdir(copy / "warnings")
    checked = call("check", name)
    if rewrite_golden:
        (CASES / "warnings" / name).with_suffix(".txt").write_bytes(checked.err.encode())
    assert checked == (0, "", expected("warnings", name))
    if not name.startswith("scene_"):
        built = call("build", name, "--quiet", "--output", "../built.urdf")
        assert built == (0, "", checked.err)


@pytest.mark.moderate
@pytest.mark.parametrize(
    "name",
    [
        "many_faults.yaml",
        "part_and_more.yaml",
        "scene_many_faults.yaml",
        "scene_meshes.yaml",
        "wide_characters.yaml",
    ],
)
def test_a_process_of_its_own_says_the_same(name: str, somo: Somo, copy: Path) -> None:
    folder = copy / "invalid"
    before = tree(folder)
    command = ("run", name, "--steps", "0") if name.startswith("scene_") else ("build", name)
    for arguments, code in ((("check", name), 1), (command, 3)):
        ended = somo(*arguments, cwd=folder)
        assert (ended.returncode, ended.stdout) == (code, "")
        assert ended.stderr == expected("invalid", name)
    assert tree(folder) == before


@pytest.mark.parametrize("folder", ["invalid", "warnings"])
def test_every_text_belongs_to_a_document(folder: str) -> None:
    stems = [Path(name).stem for name in documents(folder)]
    assert stems == sorted(path.stem for path in (CASES / folder).glob("*.txt"))


@pytest.mark.parametrize("folder", ["invalid", "warnings"])
def test_the_texts_keep_to_the_style(folder: str) -> None:
    severities = {"warnings": "warning", "invalid": "error|warning"}[folder]
    head = re.compile(rf"[\w/.]+:[1-9]\d*:[1-9]\d*: (?:{severities}): (?P<message>.+)")
    for path in (CASES / folder).glob("*.txt"):
        text = path.read_text("utf-8")
        assert text.endswith("\n")
        for line in text.splitlines():
            match = head.fullmatch(line)
            assert match or line.startswith("  "), line
            assert line == line.rstrip(), line
            if match or line.startswith("  hint: "):
                said = match["message"] if match else line.removeprefix("  hint: ")
                assert not said[0].isupper(), line
                assert not said.endswith("."), line
