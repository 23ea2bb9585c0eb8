"""The stop monitor: ends a run when a stop condition of the scene is met."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.scene.stop_conditions import (
    AXIS_NAMES,
    StopAtRest,
    StopAtTime,
    StopCondition,
    StopOnFinding,
    StopOutsideBox,
)
from somo_cli.simulation.engine.interface import World, WorldObject
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.monitoring.findings import Finding
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of

_STEP_TOLERANCE = 1e-9  # of a step: rounding may put a time that much after its step

ConditionCheck: TypeAlias = Callable[[float], str | None]
"""Takes the time [s]; returns the reason to stop, if the condition is met."""


@dataclass(frozen=True, slots=True)
class StopReason:
    """The stop condition that ended a run, counted from 0, and the reason in words."""

    condition: int
    reason: str


class StopMonitor:
    """Checks the stop conditions of a plan at the monitoring interval.

    A stop time is exact: it bounds the number of steps. `findings` returns what the run has found.
    """

    def __init__(
        self,
        plan: Plan,
        world: World,
        body_steppers: Sequence[BodyStepper],
        steps: int,
        findings: Callable[[], Sequence[Finding]] = tuple,
    ) -> None:
        times = [
            (_stop_step(stop, plan), number, stop)
            for number, stop in enumerate(plan.stop_conditions)
            if isinstance(stop, StopAtTime)
        ]
        self.steps = min([steps, *(step for step, _, _ in times)])
        """The last step of the run."""
        self._time_step = plan.time_step
        self._reason_at_last = next(
            (
                StopReason(number, f"the time is {stop.time:g} s")
                for step, number, stop in times
                if step == self.steps
            ),
            None,
        )
        self._conditions: list[tuple[int, ConditionCheck]] = [
            (
                number,
                partial(_reason_of_finding, stop, findings)
                if isinstance(stop, StopOnFinding)
                else _condition(stop, plan, world, body_steppers),
            )
            for number, stop in enumerate(plan.stop_conditions)
            if not isinstance(stop, StopAtTime)
        ]

    def check(self, step: int) -> StopReason | None:
        """Return the reason to stop at a monitored step, None to go on."""
        for number, condition in self._conditions:
            reason = condition(step * self._time_step)
            if reason is not None:
                return StopReason(number, reason)
        return None

    def at_step(self, step: int) -> StopReason | None:
        """Return the stop condition by time that ends the run at a step, None if there is none."""
        return self._reason_at_last if step >= self.steps else None


def _stop_step(stop: StopAtTime, plan: Plan) -> int:
    return math.ceil(stop.time / plan.time_step - _STEP_TOLERANCE)


def _condition(
    stop: StopCondition, plan: Plan, world: World, body_steppers: Sequence[BodyStepper]
) -> ConditionCheck:
    if isinstance(stop, StopOutsideBox):
        names = [planned.rigid_object.name for planned in plan.objects]
        rigid_object = world.objects[names.index(stop.object_name)]
        return partial(_reason_outside_bounds, stop, rigid_object, unit_factors_of(plan).length)
    assert isinstance(stop, StopAtRest)
    return _RestCondition(stop, plan, world, body_steppers).condition


def _reason_of_finding(
    stop: StopOnFinding, findings: Callable[[], Sequence[Finding]], time: float
) -> str | None:
    found = next((one for one in findings() if one.code in stop.codes), None)
    return None if found is None else f"{found.code}: {found.message}"


def _reason_outside_bounds(
    stop: StopOutsideBox, rigid_object: WorldObject, length: float, time: float
) -> str | None:
    position = rigid_object.pose().position
    for axis, low, value, high in zip(AXIS_NAMES, stop.lower, position, stop.upper, strict=True):
        if not low <= value <= high:
            bounds = f"[{low / length:g}, {high / length:g}]"
            return (
                f"'{stop.object_name}' has left {axis} in {bounds}: it is at {value / length:.6g} m"
            )
    return None


class _RestCondition:
    """Counts for how long every body has been slow."""

    def __init__(
        self, stop: StopAtRest, plan: Plan, world: World, body_steppers: Sequence[BodyStepper]
    ) -> None:
        self._stop = stop
        self._body_steppers = body_steppers
        self._velocities: list[Callable[[], tuple[Vector, Vector]]] = [
            body_stepper.world_body.base_velocity
            for body_stepper in body_steppers
            if body_stepper.body.has_moving_base
        ]
        self._velocities += [
            rigid_object.velocity
            for rigid_object, planned in zip(world.objects, plan.objects, strict=True)
            if not planned.rigid_object.is_fixed
        ]
        self._slow_since: float | None = None

    def condition(self, time: float) -> str | None:
        stop = self._stop
        if time < stop.after or not self._is_slow():
            self._slow_since = None
            return None
        if self._slow_since is None:
            self._slow_since = time
        # differences of times that are multiples of a step round either way
        if time - self._slow_since < stop.duration * (1 - 1e-9):
            return None
        return f"all has been at rest for {stop.duration:g} s"

    def _is_slow(self) -> bool:
        stop = self._stop
        if not all(body_stepper.max_rate < stop.rate for body_stepper in self._body_steppers):
            return False
        velocities = [velocity() for velocity in self._velocities]
        return all(
            geometry.norm(linear) < stop.speed and geometry.norm(spin) < stop.rate
            for linear, spin in velocities
        )
