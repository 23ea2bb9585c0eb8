"""What is wrong with a value by a JSON Schema, in words: a message and a hint for each keyword."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from somo_cli.document.schema_errors import COUNTS, BrokenRule, as_list
from somo_cli.problems import counted, did_you_mean

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

_NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


def show(value: object) -> str:
    """Return a value as YAML writes it, cut to 60 characters."""
    if isinstance(value, bool) or value is None:
        return {None: "null", True: "true", False: "false"}[value]
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:55]} ...{text[-1]}"


def filled(template: str, value: object) -> str:
    """Return an "x-message" or "x-hint" with the value, or its kind, in place of the braces."""
    return template.replace("{value}", show(value)).replace("{found}", value_and_kind(value))


def value_and_kind(value: object) -> str:
    """Return a value with its kind, such as "the string 'a'"; of a collection the kind alone."""
    if isinstance(value, str):
        return f"the string {show(value)}"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    return "nothing" if value is None else show(value)


def either(kinds: Sequence[str]) -> str:
    """Return types of JSON Schema in words, such as "a number or a list"."""
    names = list(dict.fromkeys(_KINDS[kind] for kind in kinds))
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} or {names[-1]}"


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


def sentence(description: str) -> str:
    """Return the first sentence of a description, without capital and full stop."""
    text = re.split(r"\.(?:\s+(?=[A-Z])|$)", " ".join(description.split()), maxsplit=1)[0]
    return text[:1].lower() + text[1:] if not text[1:2].isupper() else text


def _message_of_type(broken: BrokenRule) -> tuple[str, str]:
    kinds = as_list(broken.rule)
    message = f"expected {either(kinds)}, found {value_and_kind(broken.value)}"
    return message, _type_hint(broken.value, kinds)


def _message_of_choice(broken: BrokenRule) -> tuple[str, str]:
    choices = broken.rule if broken.keyword == "enum" else [broken.rule]
    one_of = "one of " if len(choices) > 1 else ""
    shown = ", ".join(show(choice) for choice in choices)
    names = [choice for choice in choices if isinstance(choice, str)]
    return f"{show(broken.value)} is not {one_of}{shown}", did_you_mean(broken.value, names, 0.7)


def _message_of_bound(broken: BrokenRule) -> tuple[str, str]:
    return f"{show(broken.value)} must be {_BOUNDS[broken.keyword]} {show(broken.rule)}", ""


def _message_of_count(broken: BrokenRule) -> tuple[str, str]:
    bound, noun = COUNTS[broken.keyword]
    counted_noun = broken.keyword[3:]
    is_exact = broken.schema.get("min" + counted_noun) == broken.schema.get("max" + counted_noun)
    bound = "" if is_exact else bound + " "
    return f"expected {bound}{counted(broken.rule, noun)}, found {len(broken.value)}", ""


def _message_of_surplus_items(broken: BrokenRule) -> tuple[str, str]:
    room = counted(len(broken.schema.get("prefixItems", ())), "value")
    return f"expected at most {room}, found {len(broken.value)}", ""


def _message_of_pattern(broken: BrokenRule) -> tuple[str, str]:
    hint = sentence(broken.schema.get("description", ""))
    return f"{show(broken.value)} does not have the right form", hint


def _message_of_repetition(_: BrokenRule) -> tuple[str, str]:
    return "the same value stands in the list twice", "remove one of them"


def _message_of_other(broken: BrokenRule) -> tuple[str, str]:
    return f"{value_and_kind(broken.value)} does not belong here", ""


_MESSAGES: Mapping[str, Callable[[BrokenRule], tuple[str, str]]] = {
    "type": _message_of_type,
    "enum": _message_of_choice,
    "const": _message_of_choice,
    **dict.fromkeys(_BOUNDS, _message_of_bound),
    **dict.fromkeys(COUNTS, _message_of_count),
    "items": _message_of_surplus_items,
    "pattern": _message_of_pattern,
    "uniqueItems": _message_of_repetition,
}
"""The message and the hint for each keyword."""


def message_and_hint(broken: BrokenRule) -> tuple[str, str]:
    """Return the message for a broken rule, and a hint unless the schema has the best one."""
    return _MESSAGES.get(broken.keyword, _message_of_other)(broken)
