"""The errors of jsonschema: what each is about, and which of them say the same."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from jsonschema.exceptions import ValidationError

from somo_cli.problems import Pointer

COUNTS = {
    "minItems": ("at least", "value"),
    "maxItems": ("at most", "value"),
    "minProperties": ("at least", "key"),
    "maxProperties": ("at most", "key"),
    "minLength": ("at least", "character"),
    "maxLength": ("at most", "character"),
}
"""The keywords that count what is in a value: the bound, and what is counted."""


@dataclass(frozen=True, slots=True)
class BrokenRule:
    """An error of jsonschema: a value, and the keyword of the schema whose rule it breaks.

    `at_key` says that the value is a key, which is then the last step of the pointer.
    """

    error: ValidationError
    pointer: Pointer
    at_key: bool
    keyword: str
    rule: Any
    value: Any
    schema: Any


def broken_rule(error: ValidationError) -> BrokenRule:
    """Return what an error of jsonschema is about."""
    value: Any = error.instance
    pointer: Pointer = tuple(error.absolute_path)
    at_key = "propertyNames" in error.absolute_schema_path and isinstance(value, str)
    if at_key:
        pointer = (*pointer, value)
    keyword, rule = str(error.validator), error.validator_value
    return BrokenRule(error, pointer, at_key, keyword, rule, value, error.schema)


def as_list(kinds: Any) -> Sequence[str]:
    """Return the types of a `type` keyword, which may be one or a list."""
    return [kinds] if isinstance(kinds, str) else kinds


def position_of(error: ValidationError) -> tuple[Pointer, int]:
    """Return the pointer of the value, and an identity of the schema that it breaks."""
    return tuple(error.absolute_path), id(error.schema)


def strictest(errors: Iterable[ValidationError]) -> Iterator[ValidationError]:
    """Yield the errors; of several counts that a value breaks, only the strictest.

    A list of four is too long for three and for two: only the smaller number helps.
    """
    kept: dict[object, ValidationError] = {}
    for error in errors:
        rule: Any = error.validator_value
        name: object = id(error)
        if error.validator in COUNTS:
            name = (tuple(error.absolute_path), error.validator)
            if name in kept:
                other: Any = kept[name].validator_value
                if (rule < other) == str(error.validator).startswith("min"):
                    continue
        kept[name] = error
    yield from kept.values()


def is_of_other_type(error: ValidationError) -> bool:
    """Whether the value itself, not a part of it, has another type than the schema wants."""
    return error.validator in ("type", "const", "enum") and len(error.relative_path) == 0


def allowed_types(errors: Iterable[ValidationError]) -> Iterator[str]:
    """Yield the types that the errors say would be right."""
    for error in errors:
        if error.validator == "type":
            yield from as_list(error.validator_value)
