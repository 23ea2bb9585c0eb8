"""Every field of every schema has a description with its unit and, for a vector, its frame."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

SCHEMAS = {
    path.name: json.loads(path.read_text("utf-8"))
    for path in sorted((Path(__file__).parents[2] / "schemas").glob("*.schema.json"))
}
UNITS = {
    *("m", "rad", "s", "kg", "Hz", "Pa", "N", "N·m", "J"),
    *("m/s", "rad/s", "m/s²", "1/m", "1/kg", "kg/m³", "kg·m²"),
    *("N/m", "N·s/m", "N·m/rad", "N·m·s/rad", "N·m/Pa"),
    "-",  # a number without a unit
    "any",  # a channel of a trajectory, whose unit the weights of a mix convert
}
_IN_BRACKETS = re.compile(r"\[([^\[\],\s]+)\]")
_FRAMES = ("world frame", "base frame", "link frame", "object's frame", "world, or body")
_OWN_WORDS = ("thing", "told", "tells", "said", "says", "led", "anew", "goes on", "lever")


def resolved(file: str, schema: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return the file and the schema that a reference leads to, or the schema itself."""
    reference = schema.get("$ref")
    if reference is None:
        return file, schema
    name, _, path = reference.partition("#")
    target: Any = SCHEMAS[name or file]
    for step in path.split("/")[1:]:
        target = target[step]
    return name or file, target


def fields(file: str, schema: Any, path: str = "") -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield file, path and schema of every field; conditions refine fields and define none."""
    if isinstance(schema, list):
        for part in schema:
            yield from fields(file, part, path)
    if not isinstance(schema, dict):
        return
    for name, field in schema.get("properties", {}).items():
        yield file, f"{path}/{name}", field
        yield from fields(file, field, f"{path}/{name}")
    for key, part in schema.items():
        if key == "$defs":
            for name, definition in part.items():
                yield from fields(file, definition, f"{path}/{name}")
        elif key not in ("properties", "if", "allOf", "not"):
            yield from fields(file, part, path)


def is_numeric(file: str, schema: Any) -> bool:
    """Return whether a value, or an item of it, may be a number."""
    if not isinstance(schema, dict):
        return False
    file, schema = resolved(file, schema)
    if {"number", "integer"} & {*_as_list(schema.get("type", ()))}:
        return True
    return any(is_numeric(file, schema.get(key)) for key in ("items", "then", "else"))


def _as_list(value: object) -> list[Any]:
    return [value] if isinstance(value, str) else list(value)  # type: ignore[call-overload]


def description(file: str, field: dict[str, Any]) -> str:
    own = field.get("description")
    return str(own if own is not None else resolved(file, field)[1].get("description", ""))


ALL = [one for file, schema in SCHEMAS.items() for one in fields(file, schema)]
NAMES = [f"{file.partition('.')[0]}{path}" for file, path, _ in ALL]


def test_the_walk_finds_fields_at_all_depths() -> None:
    assert {
        "scene/time_step",
        "scene/wave/rise",
        "scene/file/pieces",
        "scene/stop/leaves/z",
        "manipulator/world_scale/mass",
        "manipulator/link/dimensions",
        "assembly/limb/rpy",
        "sorotraj/config/setpoints/main",
    } <= set(NAMES)
    assert len(NAMES) == len(set(NAMES))


@pytest.mark.parametrize(("file", "path", "field"), ALL, ids=NAMES)
def test_a_field_has_a_description_with_its_unit(
    file: str, path: str, field: dict[str, Any]
) -> None:
    text = description(file, field)
    assert text, f"{path} has no description"
    assert not text.endswith("."), "an editor shows it without a full stop"
    found = set(_IN_BRACKETS.findall(text)) & UNITS
    if is_numeric(file, field):
        assert found, f"{path} has no unit in brackets, such as [m] or [-]: {text}"


@pytest.mark.parametrize(("file", "path", "field"), ALL, ids=NAMES)
def test_a_vector_names_its_frame(file: str, path: str, field: dict[str, Any]) -> None:
    if not field.get("$ref", "").endswith("/vector"):
        return
    text = description(file, field)
    assert any(frame in text for frame in _FRAMES) or "that frame selects" in text, (
        f"{path}: {text}"
    )


@pytest.mark.parametrize(("file", "path", "field"), ALL, ids=NAMES)
def test_a_description_has_the_words_of_the_field(
    file: str, path: str, field: dict[str, Any]
) -> None:
    words = set(re.findall(r"[a-z]+", description(file, field).lower()))
    assert words.isdisjoint(_OWN_WORDS), path


def test_units_differ_from_lists() -> None:
    assert _IN_BRACKETS.findall(
        "a [x, y, z] in [m], one of [N·m/rad], [-] (default [0, 0, 0])"
    ) == [
        "m",
        "N·m/rad",
        "-",
    ]


@pytest.mark.parametrize(
    ("schema", "numeric"),
    [
        ({"type": "number"}, True),
        ({"type": ["integer", "null"]}, True),
        ({"type": "array", "items": {"type": "array", "items": {"type": "number"}}}, True),
        ({"$ref": "manipulator.schema.json#/$defs/world_scale"}, True),
        ({"type": "boolean"}, False),
        ({"enum": ["a", "b"]}, False),
        ({"type": "array", "items": {"type": "string"}}, False),
    ],
)
def test_what_counts_as_a_number(schema: dict[str, Any], numeric: bool) -> None:
    assert is_numeric("scene.schema.json", schema) is numeric
