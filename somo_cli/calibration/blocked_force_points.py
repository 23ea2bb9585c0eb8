"""Measured blocked forces, and the joint torque that each rule gives for them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from somo_cli.analysis.text_table import table_lines, without_rounding
from somo_cli.calibration.blocked_force import blocked_equilibrium
from somo_cli.calibration.moment_arms import MomentArms
from somo_cli.calibration.report import described, with_error
from somo_cli.calibration.torque_line import TorqueLine, line
from somo_cli.manipulator.definition import Definition

Rule = Literal["exact", "somo"]


@dataclass(frozen=True, slots=True)
class BlockedForcePoint:
    """A blocked force [N], or moment [N·m] for torsion, and the joint torques behind it [N·m].

    `small` follows from the rule of small angles, `somo` from SoMo's, `equilibrium` from joint
    angles of any size, with `largest_angle` [rad]. The last two are None where springs are unknown,
    where there is no equilibrium, and for torsion, where small angles are exact. `pressure` [Pa]
    is None if unknown.
    """

    pressure: float | None
    force: float
    small: float
    somo: float
    equilibrium: float | None = None
    largest_angle: float | None = None

    def torque(self, rule: Rule) -> float:
        """Return the torque by SoMo's rule, or else the most accurate one [N·m]."""
        if rule == "somo":
            return self.somo
        return self.small if self.equilibrium is None else self.equilibrium


@dataclass(frozen=True, slots=True)
class AxisInDefinition:
    """An axis of an actuator of a definition, whose joint stiffness determines the equilibrium."""

    definition: Definition
    actuator: int
    axis: int


def blocked_force_point(
    moment_arms: MomentArms, springs: AxisInDefinition | None, pressure: float | None, force: float
) -> BlockedForcePoint:
    """Return the torques behind one measured force [N], or moment [N·m] for torsion."""
    found = None
    if springs is not None:
        found = blocked_equilibrium(
            springs.definition, springs.actuator, springs.axis, moment_arms, force
        )
    return BlockedForcePoint(
        pressure=pressure,
        force=force,
        small=moment_arms.torque(force),
        somo=moment_arms.somo_torque(force),
        equilibrium=None if found is None else found.torque,
        largest_angle=None if found is None else float(abs(found.angles).max()),
    )


def fitted_line(
    known: Sequence[BlockedForcePoint], rule: Rule, through_zero: bool
) -> TorqueLine | None:
    """Return the line of torque over pressure; None if no pressure is known."""
    pressures = [one.pressure for one in known if one.pressure is not None]
    return line(pressures, [one.torque(rule) for one in known], through_zero) if pressures else None


def lines(
    moment_arms: MomentArms,
    known: Sequence[BlockedForcePoint],
    rule: Rule,
    fit: TorqueLine | None,
) -> Iterator[str]:
    """Yield a description of the axis, the table of all forces, and the line through them."""
    yield described(moment_arms)
    yield from table_lines(list(_rows(known, fit)))
    if fit is None:
        return
    rule_note = "" if rule == "exact" else ", by SoMo's rule"
    slope = with_error(fit.per_pressure, fit.per_pressure_error, "N·m/Pa")
    yield f"torque per pressure{rule_note}: {slope}"
    size = _size(known)
    if without_rounding(fit.offset, size):
        yield f"torque without pressure: {with_error(fit.offset, fit.offset_error, 'N·m')}"
    if len(known) > 1:
        yield f"residual, root mean square: {without_rounding(fit.residual, size):.2g} N·m"


def _rows(known: Sequence[BlockedForcePoint], fit: TorqueLine | None) -> Iterator[list[str]]:
    has_pressure, has_residuals = known[0].pressure is not None, len(known) > 1
    yield [
        *(["pressure [Pa]"] if has_pressure else []),
        "force [N]", "torque [N·m]", "small angles", "SoMo's F L", "largest angle [rad]",
        *(["residual [N·m]"] if has_residuals else []),
    ]  # fmt: skip
    size = _size(known)
    for number, one in enumerate(known):
        row = [] if one.pressure is None else [f"{one.pressure:g}"]
        torques = (one.torque("exact"), one.small, one.somo)
        row += [f"{one.force:g}", *(f"{torque:.6g}" for torque in torques)]
        row.append("-" if one.largest_angle is None else f"{one.largest_angle:.3g}")
        if has_residuals and fit is not None:
            row.append(f"{without_rounding(fit.residuals[number], size):.2g}")
        yield row


def _size(known: Sequence[BlockedForcePoint]) -> float:
    """Return the largest torque [N·m], whose rounding is not a residual."""
    return max(abs(one.torque("exact")) for one in known)


def plain_data(
    known: Sequence[BlockedForcePoint], rule: Rule, fit: TorqueLine | None
) -> dict[str, object]:
    """Return all points and the line as values for JSON; None where a number is unknown."""
    about: dict[str, object] = {
        "rule": rule,
        "points": [
            {
                "pressure": one.pressure,
                "force": one.force,
                "torque": one.torque(rule),
                "torque_equilibrium": one.equilibrium,
                "torque_small_angles": one.small,
                "torque_somo": one.somo,
                "largest_angle": one.largest_angle,
            }
            for one in known
        ],
    }
    if fit is not None:
        about |= {
            "torque_per_pressure": fit.per_pressure,
            "torque_per_pressure_error": _finite(fit.per_pressure_error),
            "offset": fit.offset,
            "offset_error": _finite(fit.offset_error),
            "residuals": fit.residuals.tolist(),
        }
    return about


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
