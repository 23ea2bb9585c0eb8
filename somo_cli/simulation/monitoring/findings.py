"""Findings of a run: what a monitor saw of contact that no rigid body does."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from somo_cli.scene.stop_conditions import FindingCode


@dataclass(frozen=True, slots=True)
class Finding:
    """One finding of a run, at a time [s]: what happened, and what to do about it.

    `values` are its figures in SI, by names that carry the unit.
    """

    code: FindingCode
    time: float
    names: tuple[str, ...]
    """Of the manipulators and objects that it is about."""
    message: str
    hint: str
    values: tuple[tuple[str, float], ...] = ()

    def plain_data(self) -> dict[str, object]:
        """Return the finding as values for JSON."""
        return {
            "code": self.code,
            "time_s": self.time,
            "names": list(self.names),
            "message": self.message,
            "hint": self.hint,
            **dict(self.values),
        }


def in_order(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return findings by time, then code and names."""
    return tuple(sorted(findings, key=lambda one: (one.time, one.code, one.names)))


def half_step_hint(time_step: float) -> str:
    """Return the hint to try half the time step [s]."""
    return f"try half the step, --time-step {time_step / 2:g}"
