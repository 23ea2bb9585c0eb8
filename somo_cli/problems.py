"""What a fault is: Span, Problem and the errors a person can put right; imports nothing of ours."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Literal, TypeAlias

Pointer: TypeAlias = tuple[str | int, ...]
"""The way to a value from the root of a document, such as `("links", 0, "mass")`."""

LINE_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
"""Where the lines of a text end for YAML, and so for a Span."""

MAX_TEXT_BYTES = 1_000_000
"""The most a file of ours may hold [bytes]."""


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A place in a text; line and column count from 1, the width is in characters."""

    source: str
    line: int
    column: int
    width: int = 1


@dataclass(frozen=True, slots=True)
class Problem:
    """One fault: where it is, what is wrong with the value in it, and what would be right.

    A finding of numerics has a `code` that scripts can tell it by; info is nothing to put right.
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
    """Whether one of the problems is an error, not a warning."""
    return any(problem.severity == "error" for problem in problems)


def has_warnings(problems: Iterable[Problem]) -> bool:
    """Whether one of the problems is a warning."""
    return any(problem.severity == "warning" for problem in problems)


def did_you_mean(name: object, known: Iterable[str], likeness: float = 0.6) -> str:
    """Return a hint with the known name that is most like `name`; empty if none is like it.

    `likeness` is the least ratio of matching characters, from 0 to 1, as `difflib` has it.
    """
    close = closest_name(name, known, likeness)
    return f"did you mean '{close}'?" if close else ""


def closest_name(name: object, known: Iterable[str], likeness: float = 0.6) -> str:
    """Return the known name that is most like `name`; empty if none is, or `name` is no text."""
    close = get_close_matches(name, known, 1, likeness) if isinstance(name, str) else []
    return close[0] if close else ""


def in_reading_order(
    problems: Iterable[Problem], sources: Iterable[str] = ()
) -> tuple[Problem, ...]:
    """Sort problems by source, line and column, and drop repetitions.

    The sources given come first, the others in the order in which they first appear; problems at
    one place keep their order.
    """
    unique = tuple(dict.fromkeys(problems))
    order = dict.fromkeys((*sources, *(problem.span.source for problem in unique)))
    rank = {source: place for place, source in enumerate(order)}
    return tuple(sorted(unique, key=lambda p: (rank[p.span.source], p.span.line, p.span.column)))


class SomoError(Exception):
    """Anything the user can put right."""


class InvalidFile(SomoError):
    """Every fault of one stage; `texts` maps a source to its text, for the caret lines."""

    def __init__(self, problems: Iterable[Problem], texts: Mapping[str, str] | None = None) -> None:
        self.texts: Mapping[str, str] = dict(texts or {})
        self.problems = in_reading_order(problems, self.texts)
        # Exceptions travel between processes by their args.
        super().__init__(self.problems, self.texts)

    def __str__(self) -> str:
        return "\n".join(str(problem) for problem in self.problems)


class SimulationDiverged(SomoError):
    """The run left the region where its numbers mean anything, at `time` [s]."""

    def __init__(
        self,
        step: int,
        time: float,
        name: str,
        reason: str,
        hint: str = "",
        kind: Literal["joint", "object"] = "joint",
    ) -> None:
        self.step = step
        self.time = time
        self.name = name
        """Of the joint or the object, as `kind` says."""
        self.reason = reason
        self.hint = hint
        self.kind = kind
        super().__init__(step, time, name, reason, hint, kind)

    def __str__(self) -> str:
        return f"step {self.step} ({self.time:g} s): {self.kind} '{self.name}': {self.reason}"


class EngineRefused(SomoError):
    """The engine would not take a body we compiled."""

    def __init__(self, body: str, reason: str) -> None:
        self.body = body
        self.reason = reason
        super().__init__(body, reason)

    def __str__(self) -> str:
        return f"the engine refused '{self.body}': {self.reason}"


class ExtraMissing(SomoError):
    """An optional package is not installed."""


class EngineMissing(SomoError):
    """The engine is not installed."""
