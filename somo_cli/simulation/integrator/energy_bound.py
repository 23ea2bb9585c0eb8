"""The energy of bodies, and upper bounds on it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose, max_distances, reach_of
from somo_cli.simulation.engine.interface import WorldObject
from somo_cli.simulation.plan.joint_springs import JointSprings
from somo_cli.simulation.plan.model import Body, Plan

SMALL_ANGLE = 1e-3  # rad; deflections below it are never called divergence


class BodyEnergy:
    """The energy of one body's joints and springs, and its upper bound; engine units.

    The bound is the energy at the start, the work of actuation and loads, and the most that gravity
    can add: the whole chain stretched out and falling over once. `floor` is a negligible energy:
    every spring deflected by SMALL_ANGLE.

    For a free body that can touch something, `set_whole_energy` adds the base and the measured work
    of gravity. Otherwise a body that contact throws far away would pass for one that fell far.
    """

    def __init__(self, body: Body, springs: JointSprings, gravity: Sequence[float]) -> None:
        self.present = self.elastic = 0.0
        self.floor = float(0.5 * springs.stiffness.sum() * SMALL_ANGLE**2)
        self._springs = springs
        self._weight = geometry.norm((gravity[0], gravity[1], gravity[2]))
        self._mass = sum(link.inertial.mass for link in body.chain.links)
        self._max_gravity_work = self._weight * _fall_moment(body)
        self._given_energy = _energy_of_base(body) + self._max_gravity_work
        self._base_fall = 0.0
        self._start: tuple[float, float] | None = (
            None  # energy of the whole body, and its part in gravity
        )
        self._gravity_work = 0.0
        self._has_started = False
        self._work = self._added = 0.0
        self._max_work = 0.0
        self._angles: Array = np.zeros(len(body.chain.joints))

    @property
    def bound(self) -> float:
        """The upper bound on the energy of joints and springs, or of the whole body."""
        if self._start is not None:
            return self._start[0] + self._max_work + self._gravity_work
        return self._given_energy + self._max_work + self._base_fall

    @property
    def input_energy(self) -> float:
        """What was put in by all but gravity; of a whole body gravity's work is in it, too."""
        if self._start is not None:
            return self.bound
        return self._given_energy - self._max_gravity_work + self._max_work

    @property
    def work(self) -> float:
        """What actuation and loads have put in so far, and the bound on that of other sources."""
        return self._work + self._added

    def update(self, angles: Array, rates: Array, mass: Array) -> None:
        """Update with angles and rates, shape (n,), and the joint-space inertia, shape (n, n)."""
        springs = self._springs
        deflection = angles - springs.neutral
        deflection *= deflection
        self.elastic = 0.5 * float(springs.stiffness.dot(deflection))
        self.present = 0.5 * float(rates.dot(mass.dot(rates))) + self.elastic
        if not self._has_started:
            self._given_energy += self.present
            self._has_started = True
        self._angles = angles.copy()

    def energies(self, angles: Array, rates: Array, masses: Sequence[Array]) -> Array:
        """Return the energies of joints and springs in several states, shape (states,).

        Angles and rates have the shape (states, n); `masses` holds the inertia of each state, the
        same array object for states that share it.
        """
        springs = self._springs
        momenta: Array = np.empty_like(rates)
        first = 0
        for _, same in itertools.groupby(masses, id):
            last = first + len(list(same))
            np.matmul(rates[first:last], masses[first], momenta[first:last])
            first = last
        elastic = ((angles - springs.neutral) ** 2).dot(springs.stiffness)
        energies: Array = 0.5 * (np.einsum("ij,ij->i", rates, momenta) + elastic)
        return energies

    def set_whole_energy(self, kinetic: float, gravity: float) -> None:
        """Set the kinetic and the gravity energy of a whole free body, after `update`."""
        self.present = kinetic + self.elastic
        if self._start is None:
            self._start = self.present, gravity
        self._gravity_work = max(self._gravity_work, self._start[1] - gravity)

    def add_work(self, work: float) -> None:
        """Add work of actuation and loads, on base and joints."""
        self._work += work
        self._max_work = max(self._max_work, self._work)

    def add_energy(self, energy: float) -> None:
        """Add energy from other sources than actuation and loads to the bound."""
        self._given_energy += energy
        self._added += energy

    def bound_base_fall(self, distance: float) -> None:
        """Add what gravity can do while the base moves by a distance to the bound."""
        self._base_fall = max(self._base_fall, self._weight * self._mass * distance)

    def joint_shares(self, rates: Array, mass: Array) -> Array:
        """Return each joint's share of the present energy, shape (n,)."""
        deflection = self._angles - self._springs.neutral
        return 0.5 * (np.abs(rates * (mass @ rates)) + self._springs.stiffness * deflection**2)


class ObjectEnergyBound:
    """An upper bound on the energy that objects can have given to the joints; engine units.

    It is their energy at the start, and what gravity can have added on the way down from there.
    """

    def __init__(self, plan: Plan, objects: Sequence[WorldObject]) -> None:
        self._gravity = plan.gravity
        # with the weight and the potential of each at the start, for a unit of mass
        self._free: list[tuple[WorldObject, float, float]] = []
        self._start_energy = 0.0
        for one, planned in zip(objects, plan.objects, strict=True):
            rigid_object = planned.rigid_object
            if rigid_object.has_prescribed_pose:
                continue
            inertial = rigid_object.chain.links[0].inertial
            frame = Pose(rigid_object.position, geometry.rotation_from_rpy(rigid_object.rpy))
            self._free.append((one, inertial.mass, self._height(frame.point(inertial.centre))))
            translational = 0.5 * inertial.mass * _square(rigid_object.linear_velocity)
            rotational = (
                0.5
                * geometry.principal_moments(inertial.inertia)[2]
                * _square(rigid_object.angular_velocity)
            )
            self._start_energy += translational + rotational
        self._gravity_work = 0.0

    def energy_bound(self) -> float:
        """Return the bound at the present instant."""
        gravity_work = 0.0
        for one, mass, start in self._free:
            gravity_work += max(0.0, mass * (start - self._height(one.centre())))
        self._gravity_work = max(self._gravity_work, gravity_work)
        return self._start_energy + self._gravity_work

    def _height(self, point: Vector) -> float:
        """Return the potential of gravity at a point, for each unit of mass."""
        (x, y, z), (gx, gy, gz) = point, self._gravity
        return -(x * gx + y * gy + z * gz)


def _square(vector: Vector) -> float:
    return sum(value * value for value in vector)


def _fall_moment(body: Body) -> float:
    """Return the sum of mass times twice the distance from the base frame's origin."""
    return sum(
        2 * link.inertial.mass * (distance + geometry.norm(link.inertial.centre))
        for distance, link in zip(max_distances(body.chain), body.chain.links, strict=True)
    )


def _energy_of_base(body: Body) -> float:
    """Return a bound on the energy of the body if it moved like its base, all stretched out."""
    speed = geometry.norm(body.start.linear_velocity)
    spin = geometry.norm(body.start.angular_velocity)
    chain = body.chain
    reach = reach_of(chain) + max(geometry.norm(one.inertial.centre) for one in chain.links)
    return 0.5 * sum(
        link.inertial.mass * (speed + spin * reach) ** 2 + max(link.inertial.inertia) * spin**2
        for link in body.chain.links
    )
