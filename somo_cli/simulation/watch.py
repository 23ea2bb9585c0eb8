"""Notices that a run has diverged, by energy and speed: the numbers of one stay finite for long."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.springs import Array, Springs
from somo_cli.simulation.vibration import largest_explicit_step
from somo_cli.simulation.world import WorldThing

ANGLE_PER_STEP = math.pi  # rad; beyond, a joint's motion cannot be told from its alias
ENERGY_RATIO = 4.0  # to what was put in; an integrator at its accuracy limit stays well below 2
EXPLICIT_RATIO = 50.0  # likewise: the explicit one keeps E - h v K q / 2, so that it may have up to
# (1 + x) / (1 - x) times the energy at x = h ω / 2, its share of the limit; this is x = 0.96
SMALL_ANGLE = 1e-3  # rad; deflections below it are never called divergence


class BodyEnergy:
    """The energy of one body's joints and springs, and the most it may be; engine units.

    The bound is the energy at the start, the work of actuation and loads, and what gravity can give
    at most, with everything stretched out and falling over once. `floor` is an energy too small to
    speak of: every spring deflected by a small angle.

    Where `take_whole` is told of a free body, its base counts too, and what gravity has given: a
    body that contact throws far away is not to be taken for one that has fallen far.
    """

    def __init__(self, body: Body, springs: Springs, gravity: Sequence[float]) -> None:
        self.present = self.elastic = 0.0
        self.floor = float(0.5 * springs.stiffness.sum() * SMALL_ANGLE**2)
        self._springs = springs
        self._weight = geometry.norm((gravity[0], gravity[1], gravity[2]))
        self._mass = sum(link.inertial.mass for link in body.chain.links)
        self._given = _energy_of_base(body) + self._weight * _fall(body)
        self._base_fall = 0.0
        self._start: tuple[float, float] | None = None  # of the whole: all of it, that in gravity
        self._fallen = 0.0
        self._has_begun = False
        self._work = 0.0
        self._most_work = 0.0
        self._angles: Array = np.zeros(len(body.chain.joints))
        self._actuation: Array = np.zeros(len(body.chain.joints))

    @property
    def bound(self) -> float:
        """The most energy the joints and springs can have; of a whole body, all of it."""
        if self._start is not None:
            return self._start[0] + self._most_work + self._fallen
        return self._given + self._most_work + self._base_fall

    def update(self, angles: Array, rates: Array, actuation: Array, mass: Array) -> None:
        """Take the present state, arrays of shape (n,), and the joint-space inertia (n, n)."""
        springs = self._springs
        deflection = angles - springs.neutral
        deflection *= deflection
        self.elastic = 0.5 * float(springs.stiffness.dot(deflection))
        self.present = 0.5 * float(rates.dot(mass.dot(rates))) + self.elastic
        if self._has_begun:
            mean = actuation + self._actuation
            self._work += 0.5 * float(mean.dot(angles - self._angles))
            self._most_work = max(self._most_work, self._work)
        else:
            self._given += self.present
            self._has_begun = True
        self._angles[:] = angles
        self._actuation[:] = actuation

    def take_whole(self, kinetic: float, gravity: float) -> None:
        """Take the energies of a whole free body, after `update`: of motion, and in gravity."""
        self.present = kinetic + self.elastic
        if self._start is None:
            self._start = self.present, gravity
        self._fallen = max(self._fallen, self._start[1] - gravity)

    def give(self, work: float) -> None:
        """Add work of external loads, on base and joints; `update` comes next."""
        self._work += work

    def allow(self, energy: float) -> None:
        """Allow for energy that was put in by what is neither actuation nor load."""
        self._given += energy

    def let_base_fall(self, distance: float) -> None:
        """Allow for what gravity can give when the base has moved this far."""
        self._base_fall = max(self._base_fall, self._weight * self._mass * distance)

    def by_joint(self, rates: Array, mass: Array) -> Array:
        """Return each joint's share of the present energy, shape (n,)."""
        deflection = self._angles - self._springs.neutral
        return 0.5 * (np.abs(rates * (mass @ rates)) + self._springs.stiffness * deflection**2)


class ThingsEnergy:
    """The most energy that the objects of a scene can have given to the joints; engine units.

    What they start with, and what gravity can have given them on the way they have gone.
    """

    def __init__(self, plan: Plan, things: Sequence[WorldThing]) -> None:
        self._weight = geometry.norm(plan.gravity)
        self._free: list[tuple[WorldThing, float, Vector, float]] = []
        self._started_with = 0.0
        for one, planned in zip(things, plan.things, strict=True):
            thing = planned.thing
            if thing.is_held:
                continue
            inertial = thing.chain.links[0].inertial
            # while its frame stays, a centre of mass beside it can still fall that far
            beside = 2 * geometry.norm(inertial.centre)
            self._free.append((one, inertial.mass, thing.position, beside))
            straight = 0.5 * inertial.mass * _square(thing.linear_velocity)
            turning = 0.5 * max(inertial.inertia) * _square(thing.angular_velocity)
            self._started_with += straight + turning
        self._fallen = 0.0

    def given(self) -> float:
        """Return the bound for now."""
        if self._free:
            fallen = sum(
                mass
                * self._weight
                * (geometry.norm(geometry.subtract(one.pose().position, start)) + beside)
                for one, mass, start, beside in self._free
            )
            self._fallen = max(self._fallen, fallen)
        return self._started_with + self._fallen


class Moving(Protocol):
    """What the watch needs to know of one body in motion."""

    body: Body
    energy: BodyEnergy
    fastest: float
    mass: Array
    mass_at_start: Array

    @property
    def rates(self) -> Array:
        """Joint rates, shape (n,)."""


def check(step: int, plan: Plan, bodies: Sequence[Moving], given: float = 0.0) -> None:
    """Raise SimulationDiverged if the bodies together have more energy than they can have.

    Together, because contact moves energy from one to another; `given` is what objects may have
    added. A joint that turns too far in one step is refused as well.
    """
    limit = ANGLE_PER_STEP / plan.time_step
    ratio = EXPLICIT_RATIO if plan.integrator == "explicit" else ENERGY_RATIO
    present, bound = 0.0, ratio * given
    is_fast = False
    for one in bodies:
        present += one.energy.present
        bound += ratio * one.energy.bound + one.energy.floor
        is_fast = is_fast or not one.fastest < limit
    if is_fast or not present <= bound:
        _refuse(step, plan, bodies)


def _refuse(step: int, plan: Plan, bodies: Sequence[Moving]) -> None:
    fast = next((one for one in bodies if not one.fastest * plan.time_step < ANGLE_PER_STEP), None)
    if fast is not None:
        culprit = fast
        joint = _largest(np.abs(fast.rates))
        angle = abs(float(fast.rates[joint])) * plan.time_step
        reason = f"it turns {angle:.3g} rad in one step"
    else:
        culprit = max(bodies, key=lambda one: one.energy.present)
        joint = _largest(culprit.energy.by_joint(culprit.rates, culprit.mass))
        given = sum(max(one.energy.bound, one.energy.floor) for one in bodies)
        present = sum(one.energy.present for one in bodies)
        reason = f"the energy is {present / given:.3g} times what was put in"
    body = culprit.body
    raise SimulationDiverged(
        step,
        step * plan.time_step,
        f"{body.name}.{body.chain.joints[joint].name}",
        reason,
        _advice(plan, body, culprit.mass_at_start),
    )


def _square(vector: Vector) -> float:
    return sum(value * value for value in vector)


def _largest(values: Array) -> int:
    """Return the index of the largest value; one that is not a number counts as larger still."""
    return int(np.argmax(np.where(np.isfinite(values), values, np.inf)))


def _advice(plan: Plan, body: Body, mass: Array) -> str:
    if plan.integrator == "explicit" and np.isfinite(mass).all():
        stiffness = np.array([joint.stiffness for joint in body.chain.joints])
        damping = [joint.damping for joint in body.chain.joints]
        largest = largest_explicit_step(mass, stiffness, damping)
        return (
            f"the explicit integrator is stable below a step of {largest:.3g} s at the start; "
            "use integrator: implicit, or such a step"
        )
    if plan.integrator == "implicit":
        return f"try half the step, --time-step {plan.time_step / 2:g}, or integrator: euler"
    return f"try half the step, --time-step {plan.time_step / 2:g}"


def _fall(body: Body) -> float:
    """Return the sum of mass times twice the distance from the base frame's origin."""
    along, total = [0.0], 0.0
    for index, link in enumerate(body.chain.links):
        if index > 0:
            joint = body.chain.joints[index - 1]
            along.append(along[joint.parent] + geometry.norm(joint.origin))
        total += 2 * link.inertial.mass * (along[index] + geometry.norm(link.inertial.centre))
    return total


def _energy_of_base(body: Body) -> float:
    """Return a bound on the energy of the body if it moved like its base, all stretched out."""
    speed = geometry.norm(body.start.linear_velocity)
    spin = geometry.norm(body.start.angular_velocity)
    chain = body.chain
    reach = chain.length + max(geometry.norm(one.inertial.centre) for one in chain.links)
    if chain.limbs:  # they begin where they are mounted
        reach += max(geometry.norm(one.origin) for one in chain.joints if one.parent == 0)
    return 0.5 * sum(
        link.inertial.mass * (speed + spin * reach) ** 2 + max(link.inertial.inertia) * spin**2
        for link in body.chain.links
    )
