"""Meshes and URDFs that a scene names: read, put in place, hashed, and kept inside its folder."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

from somo_cli.document.parse import Document
from somo_cli.loading import check, load, scene_of
from somo_cli.packages import read_packages
from somo_cli.problems import InvalidFile
from tests.builders.command import Somo
from tests.builders.definitions import X, actuator, manipulator
from tests.builders.meshes import BOX_CORNERS, binary_stl, obj

URDF = """<robot name="r"><link name="a">
  <inertial><mass value="1"/><inertia ixx="2e-4" iyy="3e-4" izz="4e-4"/></inertial>
  <collision><geometry><mesh filename="../meshes/box.stl"/></geometry></collision>
  <collision><geometry><mesh filename="../meshes/box.obj"/></geometry></collision>
  <collision><geometry><mesh filename="../meshes/box.stl"/></geometry></collision>
</link></robot>
"""
OBJECTS = [
    {"name": "one", "shape_type": "mesh", "mesh": "meshes/box.stl", "mass": 1},
    {
        "name": "two",
        "shape_type": "mesh",
        "mesh": ["meshes/box.obj"],
        "mass": 1,
        "position": [-5, 0, 0],
    },
    {"name": "three", "shape_type": "urdf", "urdf": "urdf/r.urdf", "position": [5, 0, 0]},
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    scene = {
        "manipulators": [{"definition": manipulator(actuator(1, X)), "position": [9, 9, 9]}],
        "objects": OBJECTS,
    }
    for name in ("in/meshes", "in/urdf", "out"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "in/scene.json").write_text(json.dumps(scene))
    (tmp_path / "in/meshes/box.stl").write_bytes(binary_stl(BOX_CORNERS))
    (tmp_path / "in/meshes/box.obj").write_text(obj(BOX_CORNERS))
    (tmp_path / "in/urdf/r.urdf").write_text(URDF)
    (tmp_path / "out/box.obj").write_text(obj(2 * BOX_CORNERS))
    return tmp_path


def loaded(folder: Path, *sets: str, allow_outside: bool = False) -> Document:
    return load(str(folder / "in/scene.json"), sets, allow_outside)


def load_problems(folder: Path, *sets: str) -> list[str]:
    with pytest.raises(InvalidFile) as caught:
        loaded(folder, *sets)
    return [problem.message for problem in caught.value.problems]


def test_files_are_put_in_as_texts(folder: Path) -> None:
    document = loaded(folder)
    names = [str(Path(source).relative_to(folder / "in")) for source in document.texts]
    assert names == [
        "scene.json",
        "meshes/box.stl",
        "meshes/box.obj",
        "urdf/r.urdf",
        "urdf/../meshes/box.stl",
        "urdf/../meshes/box.obj",
    ]
    scene, warnings = scene_of(document)
    assert warnings == ()
    assert [len(one_object.chain.links[0].shapes) for one_object in scene.objects] == [1, 1, 3]
    # a problem of a mesh is reported where the scene names it
    assert document.span(("objects", 0, "mesh")).source == str(folder / "in/scene.json")


def test_another_mesh_can_be_set(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # as with definitions, the path is relative to the current directory
    monkeypatch.chdir(folder)
    document = loaded(folder, "objects[0].mesh=out/box.obj", "objects[0].mesh_scale=0.5")
    (found, other, _) = scene_of(document)[0].objects
    assert found.chain.links[0].inertial.inertia == pytest.approx(
        other.chain.links[0].inertial.inertia, abs=1e-12
    )


@pytest.mark.parametrize("name", ["../out/box.obj", "meshes/link.obj"])
def test_a_mesh_outside_needs_leave(folder: Path, name: str) -> None:
    (folder / "in/meshes/link.obj").symlink_to(folder / "out/box.obj")
    path = folder / "in/scene.json"
    path.write_text(path.read_text().replace("meshes/box.stl", name))
    assert load_problems(folder) == [
        f"cannot use '{name}': the path leads out of the folder '{path.parent}'"
    ]
    assert len(scene_of(loaded(folder, allow_outside=True))[0].objects) == 3


def test_a_mesh_of_a_urdf_outside_needs_leave(folder: Path) -> None:
    path = folder / "in/urdf/r.urdf"
    path.write_text(URDF.replace("../meshes/box.obj", str(folder / "out/box.obj")))
    (message,) = load_problems(folder)
    assert message.endswith("the path must be relative to the file that names it")
    assert len(scene_of(loaded(folder, allow_outside=True))[0].objects) == 3


def test_a_file_that_is_too_large(folder: Path) -> None:
    (folder / "in/urdf/r.urdf").write_text(URDF + " " * 1_000_000)
    (folder / "in/meshes/box.obj").write_text(obj(BOX_CORNERS) + " " * 20_000_000)
    assert sorted(load_problems(folder)) == [
        "the file is larger than 1000000 bytes",
        "the file is larger than 20000000 bytes",
    ]


@pytest.mark.moderate
def test_every_file_that_was_read_is_hashed(folder: Path, somo: Somo) -> None:
    pytest.importorskip("pybullet")
    ended = somo("run", "scene.json", "--steps", "2", "-q", cwd=folder / "in")
    assert (ended.returncode, ended.stderr) == (0, "")
    inputs = json.loads((folder / "in/scene.meta.json").read_text())["inputs"]
    assert len(inputs) == 6
    for source, hashes in inputs.items():
        content = (folder / "in" / source).read_bytes()
        assert hashes["sha256"] == hashlib.sha256(content).hexdigest()


@pytest.mark.moderate
def test_the_command_allows_what_lies_outside(folder: Path, somo: Somo) -> None:
    path = folder / "in/scene.json"
    path.write_text(path.read_text().replace("meshes/box.stl", "../out/box.obj"))
    assert somo("check", "in/scene.json", cwd=folder).returncode == 1
    ended = somo("check", "in/scene.json", "--allow-outside", cwd=folder)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert somo("run", "in/scene.json", "--steps", "0", cwd=folder).returncode == 3


@pytest.mark.moderate
def test_a_mesh_is_not_written_over(folder: Path, somo: Somo) -> None:
    command = ("run", "scene.json", "--steps", "0", "-o", "meshes/box.obj")
    ended = somo(*command, cwd=folder / "in")
    assert ended.returncode == 2
    assert (folder / "in/meshes/box.obj").read_text() == obj(BOX_CORNERS)


def test_files_of_a_package_are_found_where_it_is(folder: Path) -> None:
    text = URDF.replace("../meshes/box.obj", "package://thing/meshes/box.obj")
    assert "package://" in text
    for scheme in ("package", "model"):
        (folder / "in/urdf/r.urdf").write_text(text.replace("package://", f"{scheme}://"))
        (folder / "out/meshes").mkdir(exist_ok=True)
        (folder / "out/meshes/box.obj").write_text(obj(BOX_CORNERS))
        scene = str(folder / "in/scene.json")
        with pytest.raises(InvalidFile) as caught:
            load(scene, ())
        assert any("give --package thing=FOLDER" in one.message for one in caught.value.problems)
        document = load(scene, packages={"thing": str(folder / "out")})
        assert check(document) == ()
        with pytest.raises(InvalidFile):
            load(scene, packages={"other": str(folder / "out")})


def test_what_is_no_package() -> None:
    with pytest.raises(ValueError, match="is not NAME=FOLDER"):
        read_packages(["thing"])
    with pytest.raises(ValueError, match="there is no folder 'nowhere'"):
        read_packages(["thing=nowhere"])
