"""Objects that spin: a torque in every step has the engine turn them to second order."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.dynamics.gyroscopic import (
    gyroscopic_acceleration,
    half_turned,
    midpoint_rate,
)
from somo_cli.simulation.engine.interface import World, WorldObject
from somo_cli.simulation.plan.model import Plan

ENERGY_GROWTH = 2e-5  # 1/s: the relative growth of energy that is left to the engine alone,
ACCELERATION_ERROR = (
    1e-4  # rad/s²: as long as its angular acceleration is not further off than this
)
SMOOTH = 5e-3  # rad: what a change of rate in a step, times the step, is below without impacts


class RotatingObject:
    """One free object with moments that differ, engine units."""

    def __init__(self, world_object: WorldObject, time_step: float) -> None:
        self._object = world_object
        self._moments = world_object.principal_moments
        self._time_step = time_step
        self._slow_squared = _slow_rate(self._moments, time_step) ** 2
        # at the start of the last step, and the rate that it was to have; None if it had no torque
        self._last: tuple[Vector, Vector] | None = None

    def needs_torque(self) -> bool:
        """Return whether the engine alone would add energy, or be off, by more than it may."""
        _, (x, y, z) = self._object.velocity()
        if x * x + y * y + z * z < self._slow_squared:
            return False
        moments, rate, step = self._moments, self._object.principal_rate(), self._time_step
        acceleration = gyroscopic_acceleration(moments, rate)
        # evaluated half a step too early, while the axes turn with the body
        error = 0.5 * step * geometry.norm(rate) * geometry.norm(acceleration)
        gain = step * _twice_energy(moments, acceleration)
        return error > ACCELERATION_ERROR or gain > ENERGY_GROWTH * _twice_energy(moments, rate)

    def forget(self) -> None:
        """Forget the last step, after which there is one without a torque."""
        self._last = None

    def apply_torque(self) -> None:
        """Apply the torque of the coming step.

        A rate for which there is no solution is kept: the divergence monitor ends such a run.
        """
        moments, step = self._moments, self._time_step
        rate = self._object.principal_rate()
        momentum = self._momentum(rate)
        target = midpoint_rate(moments, momentum, rate, step) or rate
        self._last = momentum, target
        (a, b, c), (x, y, z), (tx, ty, tz) = moments, rate, target
        self._object.apply_principal_torque(
            (
                a * (tx - x) / step + (c - b) * y * z,
                b * (ty - y) / step + (a - c) * z * x,
                c * (tz - z) / step + (b - a) * x * y,
            )
        )

    def _momentum(self, rate: Vector) -> Vector:
        """Return the angular momentum at the present instant, in the present principal axes.

        The impulse of contacts acted at the start of the last step, so it is added there. An
        impact leaves the momentum of the rate that it led to: the solver made that rate, and the
        difference of the two, of the order of the step, would be a blow in the next one.
        """
        (a, b, c), (x, y, z), step = self._moments, rate, self._time_step
        if self._last is not None:
            (px, py, pz), (tx, ty, tz) = self._last
            dx, dy, dz = x - tx, y - ty, z - tz
            if step * max(abs(dx), abs(dy), abs(dz)) < SMOOTH:
                gained = (px + a * dx, py + b * dy, pz + c * dz)
                return half_turned(half_turned(gained, rate, step), rate, step)
        return half_turned((a * x, b * y, c * z), rate, step)


class ObjectRotations:
    """All objects of a world that may need the torque; at each check those that do are chosen."""

    def __init__(self, plan: Plan, world: World) -> None:
        self._rotating = [
            RotatingObject(world_object, plan.time_step)
            for planned, world_object in zip(plan.objects, world.objects, strict=True)
            if planned.has_gyroscopic_torque
        ]
        self._active: list[RotatingObject] = []
        self.applies: Sequence[Callable[[], None]] = ()
        """Each applies the torque of the coming step to one object."""
        self.can_act = bool(self._rotating)
        """Whether any object may ever need a torque."""

    def check(self) -> None:
        """Choose the objects that get torques until the next check."""
        active = [one for one in self._rotating if one.needs_torque()]
        for one in self._active:
            if one not in active:
                one.forget()
        self._active = active
        self.applies = [one.apply_torque for one in active]


def _twice_energy(moments: Vector, rate: Vector) -> float:
    (a, b, c), (x, y, z) = moments, rate
    return a * x * x + b * y * y + c * z * z


def _slow_rate(moments: Vector, time_step: float) -> float:
    """Return a rate [rad/s] below which no torque is needed, about whatever axis a body turns."""
    least, most = min(moments), max(moments)
    # times the square of the rate, the gyroscopic acceleration is no more
    coupling = (most - least) / least
    by_error: float = (2 * ACCELERATION_ERROR / (time_step * coupling)) ** (1 / 3)
    by_energy = math.sqrt(ENERGY_GROWTH * least / (time_step * most)) / coupling
    return min(by_error, by_energy)
