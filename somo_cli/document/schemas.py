"""The JSON Schemas of our files: how they are found, what they say of a value, their validators."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias
from urllib.parse import urljoin

from jsonschema import Draft202012Validator
from jsonschema.validators import extend
from referencing import Registry, Resource
from referencing.jsonschema import DRAFT202012

from somo_cli.problems import Pointer

_SUFFIX = ".schema.json"
FOLDERS = (
    Path(__file__).parents[1] / "schemas",  # in the wheel
    Path(__file__).parents[2] / "schemas",  # in a checkout
)
"""Where schemas are looked for, the first first."""

Schema: TypeAlias = Mapping[str, Any]


def schema_names() -> list[str]:
    """Return the names of all schemas, in the order of the alphabet."""
    paths = next((folder for folder in FOLDERS if folder.is_dir()), FOLDERS[0]).glob(f"*{_SUFFIX}")
    return sorted(path.name.removesuffix(_SUFFIX) for path in paths)


def schema_text(name: str) -> str:
    """Return the file of a schema, such as "scene"; raise FileNotFoundError without one."""
    for folder in FOLDERS:
        path = folder / f"{name}{_SUFFIX}"
        if path.is_file():
            return path.read_text("utf-8")
    raise FileNotFoundError(f"no schema named '{name}'")


@cache
def load_schema(name: str) -> Mapping[str, object]:
    """Return the schema of a name, such as "scene"; raise FileNotFoundError without one."""
    schema: Mapping[str, object] = json.loads(schema_text(name))
    return schema


def _is_whole(_: object, value: object) -> bool:
    """Return whether a value is an integer; JSON Schema takes 1.0 for one, `range` does not."""
    return isinstance(value, int) and not isinstance(value, bool)


@cache
def validator(name: str) -> Any:
    """Return the validator of a schema and of those that it refers to; 1.0 is no integer for it."""
    checker = Draft202012Validator.TYPE_CHECKER.redefine("integer", _is_whole)
    strict: Any = extend(  # type: ignore[no-untyped-call]
        Draft202012Validator, type_checker=checker
    )
    resources: dict[str, Resource[Any]] = {}
    waiting = [(str(load_schema(name).get("$id", "")), name)]
    while waiting:
        uri, current = waiting.pop()
        if uri in resources:
            continue
        schema = load_schema(current)
        # jsonschema would validate a referenced schema that has a "$schema" with its own plain
        # validator, for which 1.0 is an integer
        contents = {key: part for key, part in schema.items() if key != "$schema"}
        resources[uri] = Resource.from_contents(contents, default_specification=DRAFT202012)
        base = str(schema.get("$id", uri))
        for reference in _references(schema):
            other = reference.partition("#")[0]
            if other:
                waiting.append((urljoin(base, other), _name(other)))
    registry: Registry[Any] = Registry().with_resources(resources.items()).crawl()
    return strict(load_schema(name), registry=registry)


def _references(schema: object) -> Iterator[str]:
    if isinstance(schema, Mapping):
        if isinstance(schema.get("$ref"), str):
            yield schema["$ref"]
        for part in schema.values():
            yield from _references(part)
    elif isinstance(schema, list):
        for part in schema:
            yield from _references(part)


def _name(uri: str) -> str:
    return uri.rsplit("/", 1)[-1].removesuffix(_SUFFIX)


def subschemas(
    file: str, schema: object, pointer: Pointer, seen: frozenset[str] = frozenset()
) -> Iterator[Schema]:
    """Yield every subschema that may apply to the value at a pointer, whatever its conditions."""
    if not isinstance(schema, Mapping):
        return
    if pointer:
        yield from subschemas(file, _below(schema, pointer[0]), pointer[1:])
    else:
        yield schema
    reference = schema.get("$ref")
    if isinstance(reference, str) and f"{file}:{reference}" not in seen:
        seen |= {f"{file}:{reference}"}
        yield from subschemas(*_resolved(file, reference), pointer, seen)
    parts = [part for group in ("allOf", "anyOf", "oneOf") for part in schema.get(group, ())]
    for part in (*parts, schema.get("then"), schema.get("else")):
        yield from subschemas(file, part, pointer, seen)


def _below(schema: Schema, step: str | int) -> object:
    """Return the subschema for a key of a mapping or an item of a list, None if there is none."""
    if isinstance(step, str):
        return schema.get("properties", {}).get(step, schema.get("additionalProperties"))
    first = schema.get("prefixItems", ())
    return first[step] if step < len(first) else schema.get("items")


def _resolved(file: str, reference: str) -> tuple[str, object]:
    """Return the name of the schema file that a reference in `file` leads to, and its target."""
    other, _, way = reference.partition("#")
    file = _name(other) if other else file
    target: Any = load_schema(file)
    for step in way.split("/")[1:]:
        target = target[step.replace("~1", "/").replace("~0", "~")]
    return file, target


def unknown_and_known_keys(
    schema: Schema, value: Mapping[str, object]
) -> tuple[list[str], list[str]]:
    """Return the keys of a mapping that a schema does not know, and all that it does."""
    known = list(schema.get("properties", ()))
    patterns = list(schema.get("patternProperties", ()))
    unknown = [key for key in value if key not in known]
    return [key for key in unknown if not any(re.search(p, key) for p in patterns)], known
