"""Problems of files with their positions, and the errors that a user can correct."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal, TypeAlias

Pointer: TypeAlias = tuple[str | int, ...]
"""The keys and indices from the root of a document to a value, such as `("links", 0, "mass")`."""

LINE_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
"""A line break of YAML, and so of a Span."""

_UNIT = "[munk]?m|[mu]?s|min|rad|deg|[mk]?n|n?nm|[mk]?n_mm?|[kmh]?pa|m?bar|psi|[mk]?g|[mk]?j|hz"
_UNIT_SUFFIX = re.compile(rf"_((?:(?:{_UNIT})_)?per_(?:{_UNIT})|{_UNIT})$")

MAX_NUMBER = 1e20
"""The largest number of any file, in any unit: powers of larger ones leave the range of floats."""
MAX_TEXT_BYTES = 1_000_000
"""The largest definition or scene [bytes]."""


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A position in a text; line and column count from 1, the width is in characters."""

    source: str
    line: int
    column: int
    width: int = 1


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem of a file: its position, a message what is wrong, and a hint what to do.

    Findings that scripts may want to recognise have a `code`. An info needs no change.
    """

    span: Span
    message: str
    hint: str = ""
    severity: Literal["error", "warning", "info"] = "error"
    code: str = ""

    def __str__(self) -> str:
        span = self.span
        return f"{span.source}:{span.line}:{span.column}: {self.severity}: {self.message}"


def has_errors(problems: Iterable[Problem]) -> bool:
    """Return whether one of the problems is an error."""
    return any(problem.severity == "error" for problem in problems)


def has_warnings(problems: Iterable[Problem]) -> bool:
    """Return whether one of the problems is a warning."""
    return any(problem.severity == "warning" for problem in problems)


def pointer_text(pointer: Pointer) -> str:
    """Return a pointer in the notation of --set, such as "'links[0].mass'"."""
    steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in pointer)
    return "'" + "".join(steps).removeprefix(".") + "'" if pointer else "the file"


def counted(number: int, noun: str) -> str:
    """Return a number with its noun, such as "1 row" and "2 rows"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def shortened(text: str) -> str:
    """Return a text of a file for a message, cut to 60 characters."""
    return text if len(text) <= 60 else text[:56] + " ..."


def did_you_mean(name: object, known: Iterable[str], likeness: float = 0.6) -> str:
    """Return a hint with the known name that is most similar to `name`; empty if none is similar.

    `likeness` is the smallest accepted similarity, from 0 to 1, as `difflib` computes it.
    """
    close = closest_name(name, known, likeness)
    return f"did you mean '{close}'?" if close else ""


def closest_name(name: object, known: Iterable[str], likeness: float = 0.6) -> str:
    """Return the known name most similar to `name`; empty without one, or if `name` is no text.

    A name that ends with another unit is not similar.
    """
    if not isinstance(name, str):
        return ""
    close = get_close_matches(name, with_unit_of(name, known), 1, likeness)
    return close[0] if close else ""


def with_unit_of(name: str, known: Iterable[str]) -> list[str]:
    """Return the known names, without those that end with another unit than `name`.

    A name with force_mn in place of force_n is not misspelled: its numbers mean something else.
    """
    unit = _unit_suffix(name)
    return [one for one in known if unit is None or _unit_suffix(one) in (None, unit)]


def _unit_suffix(name: str) -> str | None:
    found = _UNIT_SUFFIX.search(name)
    return None if found is None else found[1]


def in_reading_order(
    problems: Iterable[Problem], sources: Iterable[str] = ()
) -> tuple[Problem, ...]:
    """Return problems sorted by source, line and column, each once.

    The `sources` come first, then others in the order in which they first appear. Problems at the
    same position keep their order.
    """
    unique = tuple(dict.fromkeys(problems))
    order = dict.fromkeys((*sources, *(problem.span.source for problem in unique)))
    rank = {source: place for place, source in enumerate(order)}
    return tuple(sorted(unique, key=lambda p: (rank[p.span.source], p.span.line, p.span.column)))


class SomoError(Exception):
    """An error that the user can correct."""


class InvalidFile(SomoError):
    """All problems of one stage; `texts` has the text of each source, to show its lines."""

    def __init__(self, problems: Iterable[Problem], texts: Mapping[str, str] | None = None) -> None:
        self.texts: Mapping[str, str] = dict(texts or {})
        self.problems = in_reading_order(problems, self.texts)
        # pickle constructs exceptions from their args
        super().__init__(self.problems, self.texts)

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


class SimulationDiverged(SomoError):
    """The motion of a run diverged at `time` [s]: its results are no longer meaningful."""

    def __init__(
        self,
        step: int,
        time: float,
        name: str,
        reason: str,
        hint: str = "",
        kind: Literal["joint", "manipulator", "object"] = "joint",
    ) -> None:
        self.step = step
        self.time = time
        self.name = name
        """The name of the joint, manipulator or object; `kind` says which of them it is."""
        self.reason = reason
        self.hint = hint
        self.kind = kind
        super().__init__(step, time, name, reason, hint, kind)

    def __str__(self) -> str:
        return f"step {self.step} ({self.time:g} s): {self.kind} '{self.name}': {self.reason}"


class BudgetSpent(SomoError):
    """A command has used more time or memory than an option allows it."""

    def __init__(self, reason: str, option: str, progress: str) -> None:
        self.reason = reason
        self.option = option
        self.progress = progress
        super().__init__(reason, option, progress)

    def __str__(self) -> str:
        return f"{self.reason}, the most of {self.option}; {self.progress}"


class EngineRefused(SomoError):
    """The engine did not load a body, or loaded it wrongly."""

    def __init__(self, body: str, reason: str) -> None:
        self.body = body
        self.reason = reason
        super().__init__(body, reason)

    def __str__(self) -> str:
        return f"the engine refused '{self.body}': {self.reason}"


class ExtraMissing(SomoError):
    """An optional package is not installed."""


class ClusterFailed(SomoError):
    """A cluster cannot be reached, was lost, or has another version of the package."""


class EngineMissing(SomoError):
    """The engine is not installed."""


class Terminated(KeyboardInterrupt):
    """A signal `number` has asked the program to end, as an interrupt does."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(number)
