"""A decision of a plan: a task that a run does or leaves out, why, and what that saves."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.simulation.plan.model import Plan


@dataclass(frozen=True, slots=True)
class Decision:
    """A task of a run, whether the run does it, and why.

    `saves` says what leaving it out saves in this scene, None if that is nothing or unknown.
    """

    what: str
    is_kept: bool
    why: str
    saves: str | None = None

    def __str__(self) -> str:
        saves = "" if self.saves is None else f"; saves {self.saves}"
        return f"{'kept' if self.is_kept else 'left out':8}  {self.what}: {self.why}{saves}"


def unless_asked(plan: Plan, what: str, why: str, saves: str | None) -> Decision:
    """Return the decision to leave out a task, unless everything is asked for."""
    if plan.keeps_unused:
        return Decision(what, True, f"asked for, though {why}")
    return Decision(what, False, why, saves)


def count_of(number: int, noun: str) -> str:
    """Return a number of things in words: `1 link`, `2 bodies`."""
    plural = "bodies" if noun == "body" else f"{noun}s"
    return f"{number} {noun if number == 1 else plural}"
