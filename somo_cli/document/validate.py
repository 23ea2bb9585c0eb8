"""Checks the shape of a document: which keys it has, and the types and ranges of their values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from jsonschema.exceptions import ValidationError

from somo_cli.document.parse import Document
from somo_cli.document.schema_errors import (
    BrokenRule,
    allowed_types,
    broken_rule,
    is_of_other_type,
    position_of,
    strictest,
)
from somo_cli.document.schema_messages import (
    either,
    filled,
    message_and_hint,
    sentence,
    show,
    value_and_kind,
)
from somo_cli.document.schemas import (
    Schema,
    load_schema,
    subschemas,
    unknown_and_known_keys,
    validator,
)
from somo_cli.problems import (
    MAX_NUMBER,
    Pointer,
    Problem,
    closest_name,
    did_you_mean,
    in_reading_order,
)

_Finding: TypeAlias = tuple[Pointer, bool, str, str]
"""The pointer of a value, whether the problem is with its key, the message and the hint."""


@dataclass(frozen=True, slots=True)
class SchemaProblem:
    """A problem of shape, and the pointer of the value that has it.

    The pointer of a missing key is the one that the key would have.
    """

    pointer: Pointer
    problem: Problem


def schema_problems(document: Document, schema_name: str) -> tuple[SchemaProblem, ...]:
    """Return every way in which a document does not fit a schema, in reading order.

    A schema may put "x-message" and "x-hint" beside a keyword, in place of our words; "{value}" in
    them stands for the value, "{found}" for the value and its kind.
    """
    errors = list(validator(schema_name).iter_errors(document.data))
    found = dict.fromkeys(_ErrorTranslator(document, schema_name).problems(errors))
    known = {one.pointer for one in found}
    too_large = _too_large_numbers(document, document.data)
    found |= dict.fromkeys(one for one in too_large if one.pointer not in known)
    order = in_reading_order((one.problem for one in found), document.texts)
    rank = {problem: place for place, problem in enumerate(order)}
    return tuple(sorted(found, key=lambda one: rank[one.problem]))


def soundness_test(
    problems: Iterable[SchemaProblem], missing: Iterable[Pointer] = ()
) -> Callable[[Pointer], bool]:
    """Return a test of whether the value at a pointer, with all in it, has no problem.

    `missing` are the pointers of values that are not known, such as files that cannot be read.
    """
    unsound = _prefixes([*(one.pointer for one in problems), *missing])
    return lambda pointer: pointer not in unsound


def _too_large_numbers(
    document: Document, value: object, pointer: Pointer = ()
) -> Iterator[SchemaProblem]:
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _too_large_numbers(document, part, (*pointer, key))
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from _too_large_numbers(document, part, (*pointer, index))
    elif isinstance(value, int | float) and abs(value) > MAX_NUMBER:
        hint = f"no number may be larger than {MAX_NUMBER:g}"
        problem = Problem(document.span(pointer), f"{show(value)} is too large", hint)
        yield SchemaProblem(pointer, problem)


class _ErrorTranslator:
    """Turns the errors of jsonschema into problems of one document."""

    def __init__(self, document: Document, schema_name: str) -> None:
        self._document = document
        self._schema_name = schema_name

    def problems(self, errors: Sequence[ValidationError]) -> Iterator[SchemaProblem]:
        """Yield the problem of each error, but for errors that only follow from others."""
        # a value of the wrong type breaks the other rules of the same schema as well
        mistyped = {position_of(error) for error in errors if error.validator == "type"}
        # a mapping with another error fails its branches, and then their keys count as unknown
        unsound = _prefixes(
            tuple(error.absolute_path)
            for error in errors
            if error.validator != "unevaluatedProperties"
        )
        for error in strictest(errors):
            if error.validator == "type" or position_of(error) not in mistyped:
                yield from self._translated(error, tuple(error.absolute_path) not in unsound)

    def _translated(self, error: ValidationError, is_sound: bool) -> Iterator[SchemaProblem]:
        schema = error.schema if isinstance(error.schema, Mapping) else {}
        for pointer, at_key, message, hint in self._findings(broken_rule(error), is_sound):
            if "x-message" in schema:
                message = filled(schema["x-message"], error.instance)
            if "x-hint" in schema:
                hint = filled(schema["x-hint"], error.instance)
            span = self._document.span(pointer, at_key)
            yield SchemaProblem(pointer, Problem(span, message, hint))

    def _findings(self, broken: BrokenRule, is_sound: bool) -> Iterator[_Finding]:
        pointer, value = broken.pointer, broken.value
        match broken.keyword:
            case "additionalProperties":
                yield from self._unknown(pointer, *unknown_and_known_keys(broken.schema, value))
            case "unevaluatedProperties":
                yield from self._unevaluated(pointer, broken.error, is_sound)
            case "required":
                yield from self._missing(pointer, value, broken.rule)
            case "dependentRequired":
                yield from self._missing_beside(pointer, value, broken.rule)
            case "anyOf" | "oneOf":
                yield from self._branches(pointer, broken.error)
            case "not" if broken.rule == {} and pointer:
                # a schema forbids a key by {"not": {}}: for false, jsonschema 4.26 has no position
                yield pointer, True, f"key '{pointer[-1]}' does not belong here", ""
            case keyword:
                message, hint = message_and_hint(broken)
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
        # jsonschema names the keys in its message only
        keys: Any = error.instance
        left = [key for key in keys if repr(key) in error.message]
        views = self._views(pointer)
        known = list(dict.fromkeys(key for view in views for key in view.get("properties", ())))
        yield from self._unknown(pointer, [key for key in left if key not in known], known)
        for key in left:
            if key in known and is_sound:
                yield (*pointer, key), True, f"key '{key}' does not belong here", ""

    def _branches(self, pointer: Pointer, error: ValidationError) -> Iterator[_Finding]:
        """Yield the problems of the branch that was meant, else one that names all branches."""
        branches: dict[object, list[ValidationError]] = {}
        for child in error.context or ():
            branches.setdefault(child.schema_path[0], []).append(child)
        found = value_and_kind(error.instance)
        if not branches:
            yield pointer, False, f"{found} fits more than one of the allowed forms", ""
            return
        # the branch that was meant is the one whose type the value has
        meant = [b for b in branches.values() if not any(is_of_other_type(child) for child in b)]
        kinds = [kind for branch in branches.values() for kind in allowed_types(branch)]
        if len(meant) == 1:
            yield from self._of_branch(meant[0])
        elif not meant and kinds:
            yield pointer, False, f"expected {either(kinds)}, found {found}", ""
        else:
            schema: Any = error.schema
            hint = sentence(schema.get("description", ""))
            yield pointer, False, f"{found} fits none of the allowed forms", hint

    def _of_branch(self, errors: Sequence[ValidationError]) -> Iterator[_Finding]:
        for one in self.problems(errors):
            at_key = self._document.span(one.pointer, True) == one.problem.span
            yield one.pointer, at_key, one.problem.message, one.problem.hint

    def _description(self, pointer: Pointer) -> str:
        """Return the schema's description of a value, or of the list that it is an item of.

        It is empty for a whole file, whose description is too long for a hint.
        """
        for view in self._views(pointer) if pointer else ():
            if "description" in view:
                return sentence(view["description"])
        return self._description(pointer[:-1]) if pointer and isinstance(pointer[-1], int) else ""

    def _misspelt(self, pointer: Pointer, value: Mapping[str, object]) -> set[str]:
        """Return the known keys that unknown keys of a mapping are probably meant to be."""
        meant: set[str] = set()
        for view in self._views(pointer):
            if view.get("additionalProperties") is False:
                unknown, known = unknown_and_known_keys(view, value)
                meant.update(closest_name(key, known) for key in unknown)
        return meant

    def _views(self, pointer: Pointer) -> Iterator[Schema]:
        return subschemas(self._schema_name, load_schema(self._schema_name), pointer)


def _prefixes(pointers: Iterable[Pointer]) -> set[Pointer]:
    return {pointer[:length] for pointer in pointers for length in range(len(pointer) + 1)}
