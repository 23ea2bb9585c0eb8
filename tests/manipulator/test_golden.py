"""The URDF of every definition we ship: exact bytes, and what other programs think of them.

After a change that is meant, `pytest tests/manipulator/test_golden.py --rewrite-golden` writes
the files anew; their diff is the review.
"""

from __future__ import annotations

import io
import json
import shutil
import subprocess
import sysconfig
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import pytest
import yourdfpy
from jsonschema import Draft202012Validator

from somo_cli.document.include import include
from somo_cli.document.parse import Document, parse
from somo_cli.files import open_reference
from somo_cli.manipulator import compile as compiler
from somo_cli.manipulator.compile import Compiled
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.urdf_readback import require_equal
from tests.builders.urdf_in_bullet import in_bullet

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests" / "golden"


def document_of_file(path: Path) -> Document:
    document = parse(path.read_text("utf-8"), str(path))
    if isinstance(document.data, dict) and "manipulators" in document.data:
        return document
    whole, problems = include(document, compiler.FILE_POINTERS, open_reference)
    assert problems == ()
    return whole


DOCUMENTS = {
    path.stem: document_of_file(path)
    for path in sorted(ROOT.glob("definitions/*.yaml"))
    if not path.stem.endswith("_study")
}
DEFINITIONS = sorted(name for name, it in DOCUMENTS.items() if "manipulators" not in it.data)
ASSEMBLIES = [name for name in DEFINITIONS if "limbs" in DOCUMENTS[name].data]
SCHEMAS = sorted(path.name for path in ROOT.glob("schemas/*.json"))


@cache
def compiled_file(name: str) -> Compiled:
    return compiler.compile_definition(DOCUMENTS[name])


@pytest.fixture(params=DEFINITIONS)
def name(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def golden(name: str) -> str:
    return (GOLDEN / f"{name}.urdf").read_bytes().decode()


def test_the_bytes(name: str, rewrite_golden: bool) -> None:
    path, text = GOLDEN / f"{name}.urdf", compiled_file(name).urdf()
    if rewrite_golden:
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(text.encode())
    assert path.read_bytes() == text.encode(), "see --rewrite-golden"


def test_no_golden_file_is_left_over(rewrite_golden: bool) -> None:
    for path in GOLDEN.glob("*.urdf"):
        if rewrite_golden and path.stem not in DEFINITIONS:
            path.unlink()
    assert sorted(path.stem for path in GOLDEN.glob("*.urdf")) == DEFINITIONS


def test_our_own_definitions_give_no_warning(name: str) -> None:
    assert compiled_file(name).warnings == ()


@pytest.mark.parametrize("path", sorted(ROOT.glob("definitions/*.yaml")), ids=lambda p: p.stem)
def test_an_editor_finds_the_schema(path: Path) -> None:
    first = path.read_text("utf-8").splitlines()[0]
    kind = "manipulator" if path.stem in DEFINITIONS else "scene"
    kind = "assembly" if path.stem in ASSEMBLIES else kind
    kind = "study" if path.stem.endswith("_study") else kind
    assert first == f"# yaml-language-server: $schema=../schemas/{kind}.schema.json"
    assert (path.parent / first.partition("$schema=")[2]).is_file()


# what others think of them


def test_it_is_well_formed(golden: str) -> None:
    assert ET.fromstring(golden).tag == "robot"


def test_yourdfpy_reads_what_was_meant(name: str, golden: str) -> None:
    require_equal(golden, compiled_file(name).scaled_chain(compiled_file(name).scale or Scale()))
    robot = yourdfpy.URDF.load(io.BytesIO(golden.encode()), build_scene_graph=False)
    assert robot.validate()
    assert robot.errors == []


def test_pybullet_loads_it(name: str, golden: str) -> None:
    chain = compiled_file(name).chain
    with in_bullet(golden) as (bullet, client, body):
        assert bullet.getNumJoints(body, physicsClientId=client) == len(chain.joints)


def test_mujoco_loads_it(name: str, golden: str) -> None:
    chain = compiled_file(name).chain
    model = mujoco.MjModel.from_xml_string(golden)
    assert model.njnt == len(chain.joints)
    mass = sum(link.inertial.mass for link in chain.links[1:])
    assert model.body_mass.sum() == pytest.approx(mass, rel=1e-12)


def check_urdf() -> str | None:
    """Return where urdfdom's own checker is: beside this Python, in cmeel's folder, in the path."""
    folders = (
        Path(sysconfig.get_path("scripts")),
        Path(sysconfig.get_path("purelib")) / "cmeel.prefix" / "bin",
    )
    for folder in folders:
        if found := shutil.which("check_urdf", path=str(folder)):
            return found
    return shutil.which("check_urdf")


@pytest.mark.moderate
@pytest.mark.skipif(check_urdf() is None, reason="check_urdf (cmeel-urdfdom) is not installed")
@pytest.mark.parametrize("tip_frame", [None, "tip"])
def test_check_urdf_has_nothing_to_say(name: str, tip_frame: str | None, tmp_path: Path) -> None:
    path = tmp_path / f"{name}.urdf"
    path.write_text(compiled_file(name).urdf(tip_frame=tip_frame), "utf-8")
    command = [str(check_urdf()), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    chain = compiled_file(name).chain
    links = [link.name for link in chain.links]
    if tip_frame is not None:
        links += [f"{limb.prefix}{tip_frame}" for limb in chain.backbones]
    assert all(link in done.stdout for link in links)


# the schemas, which are the reference manual


@cache
def schema_of(filename: str) -> Mapping[str, Any]:
    return json.loads((ROOT / "schemas" / filename).read_text("utf-8"))


def properties(schema: object, at: str = "") -> Iterator[tuple[str, Mapping[str, Any], bool]]:
    """Yield every property with its place, and whether it only narrows one described elsewhere."""
    if isinstance(schema, dict):
        for key, value in schema.items():
            if key == "properties":
                is_condition = at.endswith("/if") or "/allOf/" in at
                for name, it in value.items():
                    yield f"{at}/{name}", it, is_condition
            yield from properties(value, f"{at}/{key}")
    elif isinstance(schema, list):
        for place, item in enumerate(schema):
            yield from properties(item, f"{at}/{place}")


@pytest.mark.parametrize("filename", SCHEMAS)
def test_a_schema_is_a_schema(filename: str) -> None:
    schema = schema_of(filename)
    Draft202012Validator.check_schema(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["$id"] == filename


@pytest.mark.parametrize("filename", SCHEMAS)
def test_every_property_is_described(filename: str) -> None:
    schema = schema_of(filename)
    found = list(properties(schema))
    assert len(found) > 5
    bare = [
        at
        for at, it, is_condition in found
        if not is_condition and not described(it, schema.get("$defs", {}))
    ]
    assert bare == []


def described(schema: Mapping[str, Any], shared: Mapping[str, Mapping[str, Any]]) -> bool:
    """Whether it says what it is, or another of the same file says it for several."""
    name = str(schema.get("$ref", "")).removeprefix("#/$defs/")
    return bool(schema.get("description") or shared.get(name, {}).get("description"))
