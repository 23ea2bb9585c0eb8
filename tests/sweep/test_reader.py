"""Every fault of a study is reported at once, each at its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from somo_cli import document_kinds, loading
from somo_cli.packages import Access
from somo_cli.problems import InvalidFile
from somo_cli.sweep import sweep
from tests.builders.scenes import DEFINITIONS

HEAD = f"scene: {DEFINITIONS.name}/lift_scene.yaml\nduration: 1.5\n"
WRONG = """\
parameters:
  run: {values: [1]}
  size: {path: "objects[cub].mass", range: {from: 0.03, to: 0.05}}
  mass: {path: "objects[cube].mass", values: [1], expression: size}
  law: {log: {from: 0, to: 3, count: 2}}
  two: {expression: "massx * 2"}
labels:
  rise: {of: cube.pose.zz_m, take: last}
  grip: {of: left.contact.normal_n, take: time_above, period: 3}
  some: {of: "left.contact.*"}
  max: "rise > 0.05 and max(height < 0.2"
  b: "__import__('os').system('ls')"
  c: "d + 1"
  d: "c + 1"
  law: "1"
keep: "rise and foo"
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    (tmp_path / DEFINITIONS.name).symlink_to(DEFINITIONS)
    return tmp_path / "study.yaml"


def messages(path: Path, text: str) -> list[str]:
    path.write_text(text, "utf-8")
    with pytest.raises(InvalidFile) as caught:
        sweep.load(str(path), (), Access(allow_outside=True))
    return [f"{one.span.line}:{one.span.column} {one.message}" for one in caught.value.problems]


def test_all_faults_at_once(study: Path) -> None:
    assert messages(study, HEAD + WRONG) == [
        "4:3 'run' is a column of the table of results",
        "5:16 'objects[cub].mass' leads nowhere: there is no item called 'cub'",
        "5:44 missing key 'count'",
        "6:3 'mass' needs one of values, range, log, expression, and has 2",
        "7:14 the ends of log need the same sign, and not 0",
        "8:21 there is no 'massx'",
        "10:14 no column matches 'cube.pose.zz_m'",
        "11:43 time_above needs a key 'level' beside it",
        "11:55 'period' has no effect",
        "12:14 'left.contact.*' is a pattern",
        "13:3 'max' is a word of expressions",
        "13:8 this is not an expression",
        "14:6 only numbers, names, arithmetic, comparisons and functions are known",
        "15:6 'c' depends on itself",
        "17:3 'law' is a parameter as well",
        "18:7 there is no 'foo'",
    ]


PARAMETER = "parameters:\n  a: {path: time_step, values: [1e-3, 2e-3]}\n"
LABELS = "labels:\n  rise: {of: cube.pose.z_m, take: last}\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("steps: 3\n" + PARAMETER, "3:1 duration and steps exclude each other"),
        ("combine: random\n" + PARAMETER, "3:10 random needs a count"),
        ("count: 3\n" + PARAMETER, "3:1 count has no effect"),
        ("combine: {table: none.csv}\n" + PARAMETER, "3:18 'none.csv' cannot be read: No such"),
        ("combine: zip\n" + PARAMETER + "  b: {values: [1]}\n", "3:10 zip needs as many values"),
        ("parameters: {a b: {values: [1]}}\n", "3:14 'a b' is not a name"),
        ("parameters: {a: {values: [1], unit: m}}\n", "3:31 unknown key 'unit'"),
        (
            "parameters:\n  a: {range: {from: 0, to: 1, count: 2000}}\n"
            "  b: {range: {from: 0, to: 1, count: 2000}}\n",
            "3:1 these are 4000000 runs, more than 1000000",
        ),
        (
            "parameters:\n  a: {values: [0, 1]}\n  b: {expression: 1 / a}\n",
            "3:1 '1 / a' divides by zero",
        ),
    ],
)
def test_what_is_wrong_with_a_study(study: Path, text: str, message: str) -> None:
    (found,) = messages(study, HEAD + text + LABELS)
    assert found.startswith(message)


def test_a_scene_is_no_study_and_a_study_no_scene(study: Path) -> None:
    assert messages(study, "manipulators: []\n") == ["1:1 this is a scene, not a study"]
    study.write_text(HEAD + PARAMETER + LABELS, "utf-8")
    document = loading.load(str(study))
    for refuse in (loading.scene_of, document_kinds.refuse_scene):
        with pytest.raises(InvalidFile, match="this is a study, not a manipulator definition"):
            refuse(document)


def test_faults_of_the_scene_are_at_their_place_in_it(study: Path) -> None:
    study.with_name("scene.yaml").write_text("time_step: -1\nmanipulators: []\n", "utf-8")
    text = "scene: scene.yaml\nduration: 1\n" + PARAMETER + LABELS
    assert "1:12 -1 must be greater than 0" in messages(study, text)


def test_a_thousand_sets_of_a_sound_study(study: Path) -> None:
    many = "parameters:\n  a: {path: 'objects[cube].mass', range: {from: 1, to: 5, count: 1000}}\n"
    study.write_text(HEAD + many + LABELS, "utf-8")
    loaded = sweep.load(str(study), (), Access(allow_outside=True))
    assert len(loaded.study.points) == 1000
    assert loaded.study.points[-1] == {"a": 5.0}
    assert loaded.study.steps_at(1e-3) == 1500


@pytest.mark.parametrize(
    "path", sorted(DEFINITIONS.glob("*study.yaml")), ids=lambda path: path.stem
)
def test_shipped_studies_compile(path: Path) -> None:
    loaded = sweep.load(str(path), (), Access())
    runner = loaded.runner("")
    for point in (loaded.study.points[0], loaded.study.points[-1]):
        assert runner.check(point).reason == ""


def test_a_study_lasts_as_long_as_its_scene_unless_it_says_so(study: Path) -> None:
    rest = "parameters:\n  a: {path: time_step, values: [1e-3]}\n"
    rest += "labels:\n  b: {of: time_s, take: last}\n"
    scene = HEAD.splitlines()[0] + "\n" + rest
    assert messages(study, scene) == ["1:1 there is no duration"]
    study.write_text(scene, "utf-8")
    access = Access(allow_outside=True)
    assert sweep.load(str(study), ["duration=0.7"], access).study.duration == 0.7
    study.write_text(scene + "steps: 5\n", "utf-8")
    own = sweep.load(str(study), ["duration=0.7"], access).study
    assert (own.steps, own.duration) == (5, None)
