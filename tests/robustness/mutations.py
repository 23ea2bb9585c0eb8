"""Mutations of the texts of definitions, scenes, meshes and URDFs, as strangers write them."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Sequence

NUMBERS = (
    *("0", "-1", "1", "2", "-0.0", "1e-300", "-1e-9", "1e-12", "1e5", "1e19", "1e21", "-1e20"),
    *("1e308", "1e400", ".nan", "-.inf", "nan", "0x1F", "1_000", "9" * 400, "1e-400", "3.5", "0.1"),
)
WORDS = (
    *(
        "null",
        "~",
        "true",
        "no",
        "[]",
        "{}",
        "[[]]",
        "{a: 1}",
        "''",
        '"\\u0000"',
        "text",
        "[1, 2, 3]",
    ),
    *(
        "[0, 0, 0, 0]",
        "&a [*a]",
        "*a",
        "!!python/object:os.system x",
        "2020-01-01",
        "../x",
        "\ufeff",
    ),
    *("[.nan, 0, 0]", "x" * 3000, "- - - 1", "<<: {}", "? a", "|", "\x1b[31m", "\u202e", "💥"),
)
_NUMBER = re.compile(r"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
_VALUE = re.compile(r"(?<=[:,\[ ])[^\s:,\[\]{}]+")
Mutation = Callable[[random.Random, str], str]


def mutated(chance: random.Random, text: str) -> str:
    """Return a text with one to four mutations."""
    for _ in range(chance.choice((1, 1, 1, 2, 3, 4))):
        text = chance.choice(MUTATIONS)(chance, text)
    return text


def _other_number(chance: random.Random, text: str) -> str:
    return _with_match(chance, text, _NUMBER, chance.choice(NUMBERS))


def _scaled_number(chance: random.Random, text: str) -> str:
    factor = 10.0 ** chance.choice((-15, -6, -3, -1, 1, 3, 6, 15)) * chance.choice((1, -1))
    found = list(_NUMBER.finditer(text))
    if not found:
        return text
    match = chance.choice(found)
    return text[: match.start()] + repr(float(match[0]) * factor) + text[match.end() :]


def _other_value(chance: random.Random, text: str) -> str:
    return _with_match(chance, text, _VALUE, chance.choice(WORDS))


def _same_value(chance: random.Random, text: str) -> str:
    """Put a value of the text in place of another: valid where it stood, wrong elsewhere."""
    values = _VALUE.findall(text)
    return _with_match(chance, text, _VALUE, chance.choice(values)) if values else text


def _other_character(chance: random.Random, text: str) -> str:
    at = chance.randrange(len(text) + 1)
    character = chance.choice(("", ":", "-", " ", "\n", "\t", "#", "'", "[", "{", "<", "\x00", "é"))
    return text[:at] + character + text[at + chance.randrange(2) :]


def _without_line(chance: random.Random, text: str) -> str:
    return _with_lines(chance, text, lambda line: [])


def _twice_a_line(chance: random.Random, text: str) -> str:
    return _with_lines(chance, text, lambda line: [line] * chance.choice((2, 3, 40)))


def _indented_line(chance: random.Random, text: str) -> str:
    return _with_lines(chance, text, lambda line: [" " * chance.randrange(5) + line.lstrip()])


def _swapped_lines(chance: random.Random, text: str) -> str:
    lines = text.splitlines(keepends=True)
    if len(lines) < 2:
        return text
    one, other = chance.randrange(len(lines)), chance.randrange(len(lines))
    lines[one], lines[other] = lines[other], lines[one]
    return "".join(lines)


def _cut(chance: random.Random, text: str) -> str:
    return text[: chance.randrange(len(text) + 1)]


MUTATIONS: Sequence[Mutation] = (
    *(_other_number, _other_number, _scaled_number, _scaled_number, _other_value, _same_value),
    *(_same_value, _other_character, _without_line, _twice_a_line, _indented_line),
    *(_swapped_lines, _cut),
)


def _with_match(
    chance: random.Random, text: str, pattern: re.Pattern[str], replacement: str
) -> str:
    found = list(pattern.finditer(text))
    if not found:
        return text
    match = chance.choice(found)
    return text[: match.start()] + replacement + text[match.end() :]


def _with_lines(chance: random.Random, text: str, change: Callable[[str], list[str]]) -> str:
    lines = text.splitlines(keepends=True)
    if not lines:
        return text
    at = chance.randrange(len(lines))
    return "".join([*lines[:at], *change(lines[at]), *lines[at + 1 :]])
