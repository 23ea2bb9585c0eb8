"""Measured blocked forces, and the torque in the joints behind each of them by every rule."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from somo_cli.analysis.text_table import table_lines
from somo_cli.calibration.blocked_force import blocked_equilibrium
from somo_cli.calibration.moment_arms import MomentArms
from somo_cli.calibration.report import described, with_error
from somo_cli.calibration.torque_line import TorqueLine, line
from somo_cli.manipulator.definition import Definition

Rule = Literal["exact", "somo"]


@dataclass(frozen=True, slots=True)
class BlockedForcePoint:
    """A blocked force [N], or moment [N·m] for torsion, and the torques [N·m] that explain it.

    `small` is by the rule of small angles, `equilibrium` by angles of any size, of which `turned`
    [rad] is the largest; both are None where the springs are not known, where there is no
    equilibrium, and for torsion, where small angles are exact. `pressure` [Pa] may not be known.
    """

    pressure: float | None
    force: float
    small: float
    somo: float
    equilibrium: float | None = None
    largest_angle: float | None = None

    def torque(self, rule: Rule) -> float:
        """Return the best torque that is known, or that of SoMo's notes."""
        if rule == "somo":
            return self.somo
        return self.small if self.equilibrium is None else self.equilibrium


@dataclass(frozen=True, slots=True)
class AxisInDefinition:
    """Where an axis is in a definition, whose joint stiffness makes equilibria known."""

    definition: Definition
    actuator: int
    axis: int


def press(
    moment_arms: MomentArms, springs: AxisInDefinition | None, pressure: float | None, force: float
) -> BlockedForcePoint:
    """Return the torques behind one measured force."""
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


def fitted(known: Sequence[BlockedForcePoint], rule: Rule, through_zero: bool) -> TorqueLine | None:
    """Return the line of torque over pressure, None where no pressure is known."""
    pressures = [one.pressure for one in known if one.pressure is not None]
    return line(pressures, [one.torque(rule) for one in known], through_zero) if pressures else None


def lines(
    moment_arms: MomentArms,
    known: Sequence[BlockedForcePoint],
    rule: Rule,
    through: TorqueLine | None,
) -> Iterator[str]:
    """Yield the table of all forces, and the line through them."""
    yield described(moment_arms)
    header = ["force [N]", "torque [N·m]", "small angles", "SoMo's F L", "largest angle [rad]"]
    rows = []
    for number, one in enumerate(known):
        torques = one.torque("exact"), one.small, one.somo
        row = [f"{one.force:g}", *(f"{torque:.6g}" for torque in torques)]
        row.append("-" if one.largest_angle is None else f"{one.largest_angle:.3g}")
        if one.pressure is not None:
            row.insert(0, f"{one.pressure:g}")
        if len(known) > 1 and through is not None:
            row.append(f"{through.residuals[number]:.2g}")
        rows.append(row)
    if known[0].pressure is not None:
        header.insert(0, "pressure [Pa]")
    if len(known) > 1:
        header.append("residual [N·m]")
    yield from table_lines([header, *rows])
    if through is None:
        return
    of = "" if rule == "exact" else ", by SoMo's rule"
    slope = with_error(through.per_pressure, through.per_pressure_error, "N·m/Pa")
    yield f"torque per pressure{of}: {slope}"
    if through.offset:
        yield f"torque without pressure: {with_error(through.offset, through.offset_error, 'N·m')}"
    if len(known) > 1:
        yield f"residual, root mean square: {through.residual:.2g} N·m"


def plain_data(
    known: Sequence[BlockedForcePoint], rule: Rule, through: TorqueLine | None
) -> dict[str, object]:
    """Return everything as plain values, None where a number is not known."""
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
    if through is not None:
        about |= {
            "torque_per_pressure": through.per_pressure,
            "torque_per_pressure_error": _finite(through.per_pressure_error),
            "offset": through.offset,
            "offset_error": _finite(through.offset_error),
            "residuals": through.residuals.tolist(),
        }
    return about


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
