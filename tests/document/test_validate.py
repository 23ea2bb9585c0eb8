from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from somo_cli.document import schemas
from somo_cli.document.edit import embed_all, override
from somo_cli.document.parse import Document, parse
from somo_cli.document.schemas import load_schema
from somo_cli.document.validate import schema_problems, soundness_test
from somo_cli.problems import Problem

REAL = [path for folder in schemas.FOLDERS for path in folder.glob("*.schema.json")]

LINK = {
    "type": "object",
    "description": "a rigid body. It has a shape",
    "required": ["shape", "mass"],
    "additionalProperties": False,
    "properties": {
        "shape": {"enum": ["box", "cylinder", "sphere"]},
        "mass": {
            "description": "Mass of the link [kg], e.g. 0.1. Must be positive.",
            "type": "number",
            "exclusiveMinimum": 0,
        },
        "size": {
            "description": "[x, y, z] [m]",
            "type": "array",
            "minItems": 1,
            "maxItems": 3,
            "items": {"type": "number", "minimum": 0, "maximum": 10},
        },
        "name": {"$ref": "#/$defs/name"},
    },
    "allOf": [
        {
            "if": {"properties": {"shape": {"const": "sphere"}}, "required": ["shape"]},
            "then": {"properties": {"size": {"maxItems": 1, "x-hint": "a sphere has [radius]"}}},
        }
    ],
}
SCHEMAS: dict[str, Any] = {
    "body": {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            "links": {"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/link"}},
            "n": {"type": "integer", "minimum": 1, "description": "number of links"},
            "flag": {"type": "boolean"},
            "axis": {
                "type": ["array", "null"],
                "minItems": 3,
                "maxItems": 3,
                "items": {"type": "number"},
            },
            "scale": {
                "type": ["number", "object"],
                "exclusiveMinimum": 0,
                "x-message": "a scale of {value} makes no sense",
                "x-hint": "leave it out",
            },
            "base": {
                "type": ["object", "string"],
                "if": {"type": "object"},
                "then": {"$ref": "#/$defs/link"},
            },
            "named": {"type": "object", "propertyNames": {"$ref": "#/$defs/name"}},
            "pair": {"prefixItems": [{"type": "number"}, {"type": "string"}], "items": False},
            "set": {"type": "array", "uniqueItems": True},
            "step": {"type": "number", "multipleOf": 5, "maximum": 20},
            "only": {"const": "this"},
            "old": {"not": {}},
            "word": {"type": "string", "minLength": 1, "maxLength": 3},
            "some": {"type": "object", "minProperties": 1, "dependentRequired": {"a": ["b"]}},
            "any": {"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]},
            "one": {"oneOf": [{"minimum": 0}, {"maximum": 9}]},
            "not": {"description": "Anything but 5.", "not": {"const": 5}},
            "open": {
                "type": "object",
                "properties": {"kind": {"enum": ["a", "b"]}, "count": {"type": "integer"}},
                "allOf": [
                    {
                        "if": {"properties": {"kind": {"const": "a"}}},
                        "then": {"properties": {"alpha": {"type": "number"}}},
                        "else": {"properties": {"beta": {"type": "number"}}},
                    }
                ],
                "unevaluatedProperties": False,
            },
            "patterned": {
                "type": "object",
                "patternProperties": {"^x": {"type": "number"}},
                "additionalProperties": False,
            },
        },
        "$defs": {
            "link": LINK,
            "name": {
                "type": "string",
                "pattern": "^[a-z]+$",
                "description": "Lower-case letters only. No more.",
            },
        },
    },
    "world": {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": "https://example.org/schemas/world.schema.json",
        "type": "object",
        "required": ["bodies"],
        "properties": {
            "bodies": {"type": "array", "items": {"$ref": "body.schema.json"}},
            "spare": {"$ref": "body.schema.json#/$defs/link"},
        },
    },
}
KEYS = ", ".join(SCHEMAS["body"]["properties"])


def problems_in(document: Document, schema: str) -> list[Problem]:
    return [one.problem for one in schema_problems(document, schema)]


@pytest.fixture
def check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Any]]:
    for name, schema in SCHEMAS.items():
        (tmp_path / f"{name}.schema.json").write_text(json.dumps(schema), "utf-8")
    monkeypatch.setattr(schemas, "FOLDERS", (tmp_path / "none", tmp_path))
    caches = (schemas.load_schema, schemas.validator)
    for cache in caches:
        cache.cache_clear()

    def checked(text: str | Document, schema: str = "body") -> list[tuple[int, int, str, str]]:
        document = parse(text, "f") if isinstance(text, str) else text
        problems = problems_in(document, schema)
        return [(p.span.line, p.span.column, p.message, p.hint) for p in problems]

    yield checked
    for cache in caches:
        cache.cache_clear()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("n: 3\nflag: true\naxis: [1, 0.5, -2]\nbase: x.yaml\n", []),
        ("[]", [(1, 1, "expected a mapping, found a list", "")]),
        ("lnks: 1", [(1, 1, "unknown key 'lnks'", "did you mean 'links'?")]),
        ("qqqq: 1", [(1, 1, "unknown key 'qqqq'", f"known keys: {KEYS}")]),
        ("n: 'x'", [(1, 4, "expected a whole number, found the string 'x'", "number of links")]),
        (
            "n: '5'",
            [(1, 4, "expected a whole number, found the string '5'", "write 5, without quotes")],
        ),
        ("n: 1_000", [(1, 4, "expected a whole number, found the string '1_000'", "write 1000")]),
        ("n: 2.0", [(1, 4, "expected a whole number, found 2.0", "write 2")]),
        ("n: 2.5", [(1, 4, "expected a whole number, found 2.5", "number of links")]),
        ("n: true", [(1, 4, "expected a whole number, found true", "number of links")]),
        ("n:", [(1, 1, "expected a whole number, found nothing", "number of links")]),
        ("n: {}", [(1, 4, "expected a whole number, found a mapping", "number of links")]),
        ("n: -1", [(1, 4, "-1 must be at least 1", "number of links")]),
        (
            "flag: yes",
            [(1, 7, "expected true or false, found the string 'yes'", "write true or false")],
        ),
        ("flag: 1", [(1, 7, "expected true or false, found 1", "")]),
        ("axis: 1", [(1, 7, "expected a list or null, found 1", "")]),
        ("axis: [1, 2]", [(1, 7, "expected 3 values, found 2", "")]),
        (
            "axis: [1, true, '1,5']",
            [
                (1, 11, "expected a number, found true", ""),
                (1, 17, "expected a number, found the string '1,5'", "write 1.5"),
            ],
        ),
        ("links: []", [(1, 8, "expected at least 1 value, found 0", "")]),
        ("scale: 0", [(1, 8, "a scale of 0 makes no sense", "leave it out")]),
        ("scale: x", [(1, 8, "a scale of 'x' makes no sense", "leave it out")]),
        (
            "named: {ok: 1, 'N-1': 2}",
            [(1, 16, "'N-1' does not have the right form", "lower-case letters only")],
        ),
        ("pair: [1, a, 2]", [(1, 7, "expected at most 2 values, found 3", "")]),
        (
            "set: [1, 2, 1]",
            [(1, 6, "the same value stands in the list twice", "remove one of them")],
        ),
        ("step: 7", [(1, 7, "7 must be a multiple of 5", "")]),
        ("step: 25", [(1, 7, "25 must be at most 20", "")]),
        (
            "any: [1e21, -2e20, 1e-300, 1e20, 0]",
            [
                (1, 7, "1e+21 is too large", "no number may be larger than 1e+20"),
                (1, 13, "-2e+20 is too large", "no number may be larger than 1e+20"),
            ],
        ),
        ("only: that", [(1, 7, "'that' is not 'this'", "")]),
        ("only: thi", [(1, 7, "'thi' is not 'this'", "did you mean 'this'?")]),
        ("old: 1", [(1, 1, "key 'old' does not belong here", "")]),
        ("word: ''", [(1, 7, "expected at least 1 character, found 0", "")]),
        ("word: abcd", [(1, 7, "expected at most 3 characters, found 4", "")]),
        ("word: 3", [(1, 7, "expected a string, found 3", "put it in quotes")]),
        ("some: {}", [(1, 7, "expected at least 1 key, found 0", "")]),
        ("some: {a: 1}", [(1, 8, "'a' needs a key 'b' beside it", "")]),
        ("any: x", [(1, 6, "expected a number or a list, found the string 'x'", "")]),
        ("any: [1, x]", [(1, 10, "expected a number, found the string 'x'", "")]),
        ("one: 5", [(1, 6, "5 fits more than one of the allowed forms", "")]),
        ("not: 5", [(1, 6, "5 does not belong here", "anything but 5")]),
        ("open: {kind: a, alpha: 1, count: 2}", []),
        ("open: {kind: a, beta: 1}", [(1, 17, "key 'beta' does not belong here", "")]),
        (
            "open: {kind: a, alpa: 1}",
            [(1, 17, "unknown key 'alpa'", "did you mean 'alpha'?")],
        ),
        (
            "open: {kind: a, alpha: x, gamma: 1}",
            [
                (1, 24, "expected a number, found the string 'x'", ""),
                (1, 27, "unknown key 'gamma'", "known keys: kind, count, alpha, beta"),
            ],
        ),
        ("patterned: {x1: 1}", []),
        ("patterned: {y1: 1}", [(1, 13, "unknown key 'y1'", "known keys: none")]),
    ],
)
def test_a_problem_of_the_schema(
    check: Callable[..., Any], text: str, expected: list[tuple[int, int, str, str]]
) -> None:
    assert check(text) == expected


def test_all_problems_are_reported_at_once_in_reading_order(check: Callable[..., Any]) -> None:
    text = """\
n: 0
links:
- shape: bx
  mas: 1
  size: [1, .5, x, 2]
- shape: sphere
  mass: -1
  size: [1, 2, 3, 11]
  name: A
-
- {}
base:
  mass: 1
"""
    mass, size = "mass of the link [kg], e.g. 0.1", "[x, y, z] [m]"
    assert check(text) == [
        (1, 4, "0 must be at least 1", "number of links"),
        (3, 10, "'bx' is not one of 'box', 'cylinder', 'sphere'", "did you mean 'box'?"),
        (4, 3, "unknown key 'mas'", "did you mean 'mass'?"),
        (5, 9, "expected at most 3 values, found 4", size),
        (5, 17, "expected a number, found the string 'x'", size),
        (7, 9, "-1 must be greater than 0", mass),
        (8, 9, "expected at most 1 value, found 4", "a sphere has [radius]"),
        (8, 19, "11 must be at most 10", size),
        (9, 9, "'A' does not have the right form", "lower-case letters only"),
        (10, 2, "expected a mapping, found nothing", "a rigid body"),
        (11, 3, "missing key 'shape'", ""),
        (11, 3, "missing key 'mass'", mass),
        (12, 1, "missing key 'shape'", ""),
    ]


def test_schemas_refer_to_each_other(check: Callable[..., Any]) -> None:
    text = "bodies:\n- n: 0\n- links: [{shape: box, mass: 0}]\nspare: {shape: box}\n"
    assert check(text, "world") == [
        (2, 6, "0 must be at least 1", "number of links"),
        (3, 30, "0 must be greater than 0", "mass of the link [kg], e.g. 0.1"),
        (4, 1, "missing key 'mass'", "mass of the link [kg], e.g. 0.1"),
    ]
    assert check("bodies:\n- n: 2.0\n", "world") == [
        (2, 6, "expected a whole number, found 2.0", "write 2")
    ]
    assert check("{}", "world") == [(1, 1, "missing key 'bodies'", "")]


def test_a_problem_of_an_embedded_file_has_its_position_there(check: Callable[..., Any]) -> None:
    whole = embed_all(
        parse("base: part\n", "f"), {("base",): parse("\nmass: 0\ncolor: 1\n", "part")}
    )
    places = [(p.span.source, p.span.line, p.span.column) for p in problems_in(whole, "body")]
    assert places == [("part", 1, 1), ("part", 2, 7), ("part", 3, 1)]


def test_a_problem_of_an_override_has_its_position_there(check: Callable[..., Any]) -> None:
    document = parse("n: 0\nbase: {shape: box, mass: 1}\n", "f")
    for assignment in ("base.mass=-1", "nn=2", "axis=[1, 2]"):
        document = override(document, assignment)
    places = [(p.span.source, p.span.column, p.span.width) for p in problems_in(document, "body")]
    assert places == [
        ("f", 4, 1),
        ("--set 'base.mass'", 11, 2),
        ("--set 'nn'", 1, 2),
        ("--set 'axis'", 6, 1),
    ]


def test_soundness_of_pointers(check: Callable[..., Any]) -> None:
    document = parse("n: 0\nlinks: [{shape: box}, {shape: box, mass: 1}]\n", "f")
    found = schema_problems(document, "body")
    assert [problem.pointer for problem in found] == [("n",), ("links", 0, "mass")]
    is_sound = soundness_test(found)
    assert not is_sound(())
    assert not is_sound(("n",))
    assert not is_sound(("links",))
    assert not is_sound(("links", 0))
    assert is_sound(("links", 0, "shape"))
    assert is_sound(("links", 1))
    assert soundness_test(())(())


def test_a_long_value_is_cut_in_the_message(check: Callable[..., Any]) -> None:
    [(_, _, message, _)] = check(f"n: {'x' * 10_000}")
    assert len(message) < 120


def test_thousands_of_problems_take_seconds_at_most(check: Callable[..., Any]) -> None:
    text = "links:\n" + "- {shape: bx, mas: 1}\n" * 1_000
    start = time.process_time()
    assert len(check(text)) == 2_000
    assert time.process_time() - start < 60


def test_an_unknown_schema_is_an_error_of_the_program(check: Callable[..., Any]) -> None:
    with pytest.raises(FileNotFoundError, match="no schema named 'nonsense'"):
        load_schema("nonsense")


def subschemas(schema: object) -> Iterator[Mapping[str, Any]]:
    if isinstance(schema, dict):
        yield schema
        for part in schema.values():
            yield from subschemas(part)
    elif isinstance(schema, list):
        for part in schema:
            yield from subschemas(part)


@pytest.mark.parametrize("path", REAL, ids=lambda path: path.name)
class TestTheRealSchemas:
    def test_is_a_schema(self, path: Path) -> None:
        schema = load_schema(path.name.removesuffix(".schema.json"))
        schemas.Draft202012Validator.check_schema(schema)

    def test_says_something_of_everything(self, path: Path) -> None:
        name = path.name.removesuffix(".schema.json")
        for text in ("5", "[]", "{}", "{nonsense: 1}"):
            problems = problems_in(parse(text, "f"), name)
            assert problems
            assert all(problem.message for problem in problems)

    def test_every_key_can_be_wrong(self, path: Path) -> None:
        name = path.name.removesuffix(".schema.json")
        keys = {k for s in subschemas(load_schema(name)) for k in s.get("properties", ())}
        for value in ("[[]]", "{x: {}}", "-1", "''", "true", "null", "x y"):
            text = "".join(f"{key}: {value}\n" for key in sorted(keys))
            for problem in problems_in(parse(text, "f"), name):
                assert 1 <= problem.span.line <= len(keys)
