"""A Document against a JSON Schema, as Problems; the only place jsonschema is known."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias
from urllib.parse import urljoin

from jsonschema import Draft202012Validator
from jsonschema.exceptions import ValidationError
from jsonschema.validators import extend
from referencing import Registry, Resource
from referencing.jsonschema import DRAFT202012

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem, closest_name, did_you_mean, in_reading_order

_SUFFIX = ".schema.json"
_FOLDERS = (
    Path(__file__).parents[1] / "schemas",  # in the wheel
    Path(__file__).parents[2] / "schemas",  # in a checkout
)
_KINDS = {
    "object": "a mapping",
    "array": "a list",
    "string": "a string",
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
    "null": "null",
}
_BOUNDS = {
    "minimum": "at least",
    "maximum": "at most",
    "exclusiveMinimum": "greater than",
    "exclusiveMaximum": "less than",
    "multipleOf": "a multiple of",
}
_COUNTS = {
    "minItems": ("at least", "value"),
    "maxItems": ("at most", "value"),
    "minProperties": ("at least", "key"),
    "maxProperties": ("at most", "key"),
    "minLength": ("at least", "character"),
    "maxLength": ("at most", "character"),
}

MAX_NUMBER = 1e20  # number, in whatever unit

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")

Schema: TypeAlias = Mapping[str, Any]
_Finding: TypeAlias = tuple[Pointer, bool, str, str]  # what, whether at its key, message, hint


@cache
def load_schema(name: str) -> Mapping[str, object]:
    """Return the schema of that name, "manipulator" or "scene"."""
    for folder in _FOLDERS:
        path = folder / f"{name}{_SUFFIX}"
        if path.is_file():
            schema: Mapping[str, object] = json.loads(path.read_text("utf-8"))
            return schema
    raise FileNotFoundError(f"no schema named '{name}'")


@dataclass(frozen=True, slots=True)
class SchemaProblem:
    """A problem of shape, and the pointer it is about; that of a missing key leads to nothing."""

    pointer: Pointer
    problem: Problem


def schema_problems(document: Document, schema_name: str) -> tuple[SchemaProblem, ...]:
    """Return every way in which a document does not fit a schema, in reading order.

    A schema may put "x-message" and "x-hint" beside a keyword, in place of our words; "{value}" in
    them stands for the value, "{found}" for the value and its kind.
    """
    errors = list(_validator(schema_name).iter_errors(document.data))
    faults = dict.fromkeys(_ErrorTranslator(document, schema_name).faults(errors))
    flawed = {fault.pointer for fault in faults}
    extremes = _extremes(document, document.data)
    faults |= dict.fromkeys(fault for fault in extremes if fault.pointer not in flawed)
    order = in_reading_order((fault.problem for fault in faults), document.texts)
    rank = {problem: place for place, problem in enumerate(order)}
    return tuple(sorted(faults, key=lambda fault: rank[fault.problem]))


def soundness_test(
    faults: Iterable[SchemaProblem], missing: Iterable[Pointer] = ()
) -> Callable[[Pointer], bool]:
    """Return a test of whether nothing is at fault or missing at a pointer or below it."""
    unsound = _prefixes([*(fault.pointer for fault in faults), *missing])
    return lambda pointer: pointer not in unsound


def _extremes(document: Document, value: object, pointer: Pointer = ()) -> Iterator[SchemaProblem]:
    # Numbers whose powers leave the range of floats.
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _extremes(document, part, (*pointer, key))
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from _extremes(document, part, (*pointer, index))
    elif isinstance(value, int | float) and abs(value) > MAX_NUMBER:
        hint = f"no number may be larger than {MAX_NUMBER:g}"
        problem = Problem(document.span(pointer), f"{_show(value)} is too large", hint)
        yield SchemaProblem(pointer, problem)


@dataclass(frozen=True, slots=True)
class _BrokenRule:
    """An error of jsonschema: a value, and the keyword of the schema whose rule it breaks.

    `at_key` tells that the value is a key, which the last step of the pointer then is.
    """

    error: ValidationError
    pointer: Pointer
    at_key: bool
    keyword: str
    rule: Any
    value: Any
    schema: Any


def _broken_rule(error: ValidationError) -> _BrokenRule:
    value: Any = error.instance
    pointer: Pointer = tuple(error.absolute_path)
    at_key = "propertyNames" in error.absolute_schema_path and isinstance(value, str)
    if at_key:
        pointer = (*pointer, value)
    keyword, rule = str(error.validator), error.validator_value
    return _BrokenRule(error, pointer, at_key, keyword, rule, value, error.schema)


class _ErrorTranslator:
    """Turns the errors of jsonschema into faults of one document."""

    def __init__(self, document: Document, schema_name: str) -> None:
        self._document = document
        self._schema_name = schema_name

    def faults(self, errors: Sequence[ValidationError]) -> Iterator[SchemaProblem]:
        """Say each error in our words, without those that only follow from another."""
        # A value of the wrong type breaks the other rules beside it as well.
        mistyped = {_place(error) for error in errors if error.validator == "type"}
        # A mapping with another fault fails its branches, and then their keys count as unknown.
        unsound = _prefixes(
            tuple(error.absolute_path)
            for error in errors
            if error.validator != "unevaluatedProperties"
        )
        for error in _strictest(errors):
            if error.validator == "type" or _place(error) not in mistyped:
                yield from self._translated(error, tuple(error.absolute_path) not in unsound)

    def _translated(self, error: ValidationError, is_sound: bool) -> Iterator[SchemaProblem]:
        schema = error.schema if isinstance(error.schema, Mapping) else {}
        for pointer, at_key, message, hint in self._findings(_broken_rule(error), is_sound):
            if "x-message" in schema:
                message = _filled(schema["x-message"], error.instance)
            if "x-hint" in schema:
                hint = _filled(schema["x-hint"], error.instance)
            span = self._document.span(pointer, at_key)
            yield SchemaProblem(pointer, Problem(span, message, hint))

    def _findings(self, broken: _BrokenRule, is_sound: bool) -> Iterator[_Finding]:
        pointer, value = broken.pointer, broken.value
        match broken.keyword:
            case "additionalProperties":
                yield from self._unknown(pointer, *_surplus(broken.schema, value))
            case "unevaluatedProperties":
                yield from self._unevaluated(pointer, broken.error, is_sound)
            case "required":
                yield from self._missing(pointer, value, broken.rule)
            case "dependentRequired":
                yield from self._missing_beside(pointer, value, broken.rule)
            case "anyOf" | "oneOf":
                yield from self._branches(pointer, broken.error)
            case "not" if broken.rule == {} and pointer:
                # Not a schema of false: jsonschema 4.26 does not say where that one stands.
                yield pointer, True, f"key '{pointer[-1]}' does not belong here", ""
            case keyword:
                message, hint = _SAID.get(keyword, _said_of_other)(broken)
                hint = hint or self._description(pointer)
                if keyword == "pattern":
                    hint = hint or f"form: {broken.rule}"
                yield pointer, broken.at_key, message, hint

    def _missing(
        self, pointer: Pointer, value: Mapping[str, object], names: Iterable[str]
    ) -> Iterator[_Finding]:
        misspelt = self._misspelt(pointer, value)
        for name in names:
            if name not in value and name not in misspelt:
                place = (*pointer, name)
                yield place, False, f"missing key '{name}'", self._description(place)

    def _missing_beside(
        self, pointer: Pointer, value: Mapping[str, object], needs: Mapping[str, Sequence[str]]
    ) -> Iterator[_Finding]:
        present = [(name, others) for name, others in needs.items() if name in value]
        for name, others in present:
            for other in others:
                if other not in value:
                    message = f"'{name}' needs a key '{other}' beside it"
                    yield (*pointer, name), True, message, self._description((*pointer, other))

    def _unknown(
        self, pointer: Pointer, unknown: Iterable[str], known: Sequence[str]
    ) -> Iterator[_Finding]:
        for key in unknown:
            hint = did_you_mean(key, known) or f"known keys: {', '.join(known) or 'none'}"
            yield (*pointer, key), True, f"unknown key '{key}'", hint

    def _unevaluated(
        self, pointer: Pointer, error: ValidationError, is_sound: bool
    ) -> Iterator[_Finding]:
        # jsonschema tells the keys nowhere but in its message.
        keys: Any = error.instance
        left = [key for key in keys if repr(key) in error.message]
        views = self._views(pointer)
        known = list(dict.fromkeys(key for view in views for key in view.get("properties", ())))
        yield from self._unknown(pointer, [key for key in left if key not in known], known)
        for key in left:
            if key in known and is_sound:
                yield (*pointer, key), True, f"key '{key}' does not belong here", ""

    def _branches(self, pointer: Pointer, error: ValidationError) -> Iterator[_Finding]:
        """Yield the faults of the branch that was meant, or else what all branches allow."""
        branches: dict[object, list[ValidationError]] = {}
        for child in error.context or ():
            branches.setdefault(child.schema_path[0], []).append(child)
        found = _value_and_kind(error.instance)
        if not branches:
            yield pointer, False, f"{found} fits more than one of the allowed forms", ""
            return
        # The branch that was meant is the one the value is of the right kind for.
        meant = [b for b in branches.values() if not any(_is_other_kind(child) for child in b)]
        kinds = [kind for branch in branches.values() for kind in _allowed_kinds(branch)]
        if len(meant) == 1:
            yield from self._of_branch(meant[0])
        elif not meant and kinds:
            yield pointer, False, f"expected {_either(kinds)}, found {found}", ""
        else:
            schema: Any = error.schema
            hint = _sentence(schema.get("description", ""))
            yield pointer, False, f"{found} fits none of the allowed forms", hint

    def _of_branch(self, errors: Sequence[ValidationError]) -> Iterator[_Finding]:
        for fault in self.faults(errors):
            at_key = self._document.span(fault.pointer, True) == fault.problem.span
            yield fault.pointer, at_key, fault.problem.message, fault.problem.hint

    def _description(self, pointer: Pointer) -> str:
        # What the schema says of a value, else of the list it is in; of a file it says too much.
        for view in self._views(pointer) if pointer else ():
            if "description" in view:
                return _sentence(view["description"])
        return self._description(pointer[:-1]) if pointer and isinstance(pointer[-1], int) else ""

    def _misspelt(self, pointer: Pointer, value: Mapping[str, object]) -> set[str]:
        # The keys that the unknown keys of a mapping were probably meant to be.
        meant: set[str] = set()
        for view in self._views(pointer):
            if view.get("additionalProperties") is False:
                unknown, known = _surplus(view, value)
                meant.update(closest_name(key, known) for key in unknown)
        return meant

    def _views(self, pointer: Pointer) -> Iterator[Schema]:
        return _views(self._schema_name, load_schema(self._schema_name), pointer)


def _prefixes(pointers: Iterable[Pointer]) -> set[Pointer]:
    return {pointer[:length] for pointer in pointers for length in range(len(pointer) + 1)}


def _place(error: ValidationError) -> tuple[Pointer, int]:
    return tuple(error.absolute_path), id(error.schema)


def _strictest(errors: Iterable[ValidationError]) -> Iterator[ValidationError]:
    # A list of four is too long for three and for two; only the smaller number helps.
    kept: dict[object, ValidationError] = {}
    for error in errors:
        rule: Any = error.validator_value
        name: object = id(error)
        if error.validator in _COUNTS:
            name = (tuple(error.absolute_path), error.validator)
            if name in kept:
                other: Any = kept[name].validator_value
                if (rule < other) == str(error.validator).startswith("min"):
                    continue
        kept[name] = error
    yield from kept.values()


def _surplus(schema: Schema, value: Mapping[str, object]) -> tuple[list[str], list[str]]:
    # The keys that are unknown, and those that are known.
    known = list(schema.get("properties", ()))
    patterns = list(schema.get("patternProperties", ()))
    unknown = [key for key in value if key not in known]
    return [key for key in unknown if not any(re.search(p, key) for p in patterns)], known


def _is_other_kind(error: ValidationError) -> bool:
    return error.validator in ("type", "const", "enum") and len(error.relative_path) == 0


def _allowed_kinds(errors: Iterable[ValidationError]) -> Iterator[str]:
    for error in errors:
        if error.validator == "type":
            yield from _as_list(error.validator_value)


def _views(
    file: str, schema: object, pointer: Pointer, seen: frozenset[str] = frozenset()
) -> Iterator[Schema]:
    """Yield every subschema that may judge the value at a pointer, whatever its conditions."""
    if not isinstance(schema, Mapping):
        return
    if pointer:
        yield from _views(file, _below(schema, pointer[0]), pointer[1:])
    else:
        yield schema
    reference = schema.get("$ref")
    if isinstance(reference, str) and f"{file}:{reference}" not in seen:
        seen |= {f"{file}:{reference}"}
        yield from _views(*_resolved(file, reference), pointer, seen)
    parts = [part for group in ("allOf", "anyOf", "oneOf") for part in schema.get(group, ())]
    for part in (*parts, schema.get("then"), schema.get("else")):
        yield from _views(file, part, pointer, seen)


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


def _is_whole(_: object, value: object) -> bool:
    # JSON Schema takes 1.0 for an integer; range(1.0) does not.
    return isinstance(value, int) and not isinstance(value, bool)


@cache
def _validator(name: str) -> Any:
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
        # With its "$schema", a schema that another one refers to would be judged by the plain
        # validator, for which 1.0 is an integer.
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


def _show(value: object) -> str:
    if isinstance(value, bool) or value is None:
        return {None: "null", True: "true", False: "false"}[value]
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:55]} ...{text[-1]}"


def _filled(template: str, value: object) -> str:
    return template.replace("{value}", _show(value)).replace("{found}", _value_and_kind(value))


def _value_and_kind(value: object) -> str:
    if isinstance(value, str):
        return f"the string {_show(value)}"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    return "nothing" if value is None else _show(value)


def _either(kinds: Sequence[str]) -> str:
    names = list(dict.fromkeys(_KINDS[kind] for kind in kinds))
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} or {names[-1]}"


def _as_list(kinds: Any) -> Sequence[str]:
    return [kinds] if isinstance(kinds, str) else kinds


def _type_hint(value: object, kinds: Sequence[str]) -> str:
    """Return what was probably meant by a value of the wrong type, or nothing."""
    if "boolean" in kinds and isinstance(value, str):
        return "write true or false"
    if "integer" in kinds and isinstance(value, float) and value.is_integer():
        return f"write {int(value)}"
    if "string" in kinds and "object" not in kinds and isinstance(value, int | float):
        return "put it in quotes"
    if isinstance(value, str) and not {"number", "integer"}.isdisjoint(kinds):
        return _number_hint(value)
    return ""


def _number_hint(value: str) -> str:
    for text in (value, value.replace("_", ""), value.replace(",", ".")):
        if _NUMBER.fullmatch(text):
            return f"write {text}, without quotes" if text == value else f"write {text}"
    return ""


def _plural(count: int, thing: str) -> str:
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def _sentence(description: str) -> str:
    # The first sentence, as it stands after a colon.
    text = re.split(r"\.(?:\s+(?=[A-Z])|$)", " ".join(description.split()), maxsplit=1)[0]
    return text[:1].lower() + text[1:] if not text[1:2].isupper() else text


def _said_of_type(broken: _BrokenRule) -> tuple[str, str]:
    kinds = _as_list(broken.rule)
    message = f"expected {_either(kinds)}, found {_value_and_kind(broken.value)}"
    return message, _type_hint(broken.value, kinds)


def _said_of_choice(broken: _BrokenRule) -> tuple[str, str]:
    choices = broken.rule if broken.keyword == "enum" else [broken.rule]
    one_of = "one of " if len(choices) > 1 else ""
    shown = ", ".join(_show(choice) for choice in choices)
    names = [choice for choice in choices if isinstance(choice, str)]
    return f"{_show(broken.value)} is not {one_of}{shown}", did_you_mean(broken.value, names, 0.7)


def _said_of_bound(broken: _BrokenRule) -> tuple[str, str]:
    return f"{_show(broken.value)} must be {_BOUNDS[broken.keyword]} {_show(broken.rule)}", ""


def _said_of_count(broken: _BrokenRule) -> tuple[str, str]:
    bound, thing = _COUNTS[broken.keyword]
    counted = broken.keyword[3:]
    is_exact = broken.schema.get("min" + counted) == broken.schema.get("max" + counted)
    bound = "" if is_exact else bound + " "
    return f"expected {bound}{_plural(broken.rule, thing)}, found {len(broken.value)}", ""


def _said_of_surplus_items(broken: _BrokenRule) -> tuple[str, str]:
    room = _plural(len(broken.schema.get("prefixItems", ())), "value")
    return f"expected at most {room}, found {len(broken.value)}", ""


def _said_of_pattern(broken: _BrokenRule) -> tuple[str, str]:
    hint = _sentence(broken.schema.get("description", ""))
    return f"{_show(broken.value)} does not have the right form", hint


def _said_of_repetition(_: _BrokenRule) -> tuple[str, str]:
    return "the same value stands in the list twice", "remove one of them"


def _said_of_other(broken: _BrokenRule) -> tuple[str, str]:
    return f"{_value_and_kind(broken.value)} does not belong here", ""


# The message and the hint for a broken keyword; without a hint, the description stands in.
_SAID: Mapping[str, Callable[[_BrokenRule], tuple[str, str]]] = {
    "type": _said_of_type,
    "enum": _said_of_choice,
    "const": _said_of_choice,
    **dict.fromkeys(_BOUNDS, _said_of_bound),
    **dict.fromkeys(_COUNTS, _said_of_count),
    "items": _said_of_surplus_items,
    "pattern": _said_of_pattern,
    "uniqueItems": _said_of_repetition,
}
