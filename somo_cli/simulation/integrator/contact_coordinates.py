"""What moves where contact is foreseen: joints, bases and objects, each with its compliance.

Each part has coordinates of its own: of joints their rates, of a base or an object its angular
velocity and the velocity of its centre of mass, in the world. A part tells how points on it move
with its coordinates (a Jacobian), what a generalised force changes (a compliance: an acceleration
for a force), and the coordinates now and at the end of the coming step if no contact force changes.
"""

from __future__ import annotations

from typing import Protocol, TypeAlias, cast

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.cross_products import skew_matrices
from somo_cli.simulation.engine.interface import WorldFreeBody, WorldObject
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.floating_base import FloatingBase
from somo_cli.simulation.integrator.prescribed_base import PrescribedBase

Motion: TypeAlias = tuple[float, ...]
"""Angular velocity, then velocity, six numbers."""


class Part(Protocol):
    """One body or object."""

    size: int
    """How many coordinates it has."""
    joints: int
    """How many of them, the first, are joints, which follow the law."""
    links_others: bool
    """Whether a force on it is felt by what else touches it."""
    has_fixed_coordinates: bool
    """Whether its coordinates stay what they are when another Jacobian is asked for."""

    def jacobian(self, links: Array, points: Array) -> Array:
        """Return how points of links, (m, 3) in the world, move, shape (m, 3, size)."""

    def response(self, forces: Array) -> Array:
        """Return the accelerations, (size, k), that generalised forces, (size, k), bring."""

    def angles(self) -> Array:
        """Return the joint angles, shape (joints,)."""

    def observe(self) -> None:
        """Take the present motion, in every step in which something is near."""

    def write(self, now: Array, coming: Array) -> None:
        """Fill in the coordinates now, and at the end of the coming step, (size,) each."""


class Joints:
    """The joints of a body whose base is held."""

    links_others = True
    has_fixed_coordinates = True

    def __init__(self, stepper: BodyStepper) -> None:
        self.stepper = stepper
        self.joints = self.size = len(stepper.law.rates)

    def jacobian(self, links: Array, points: Array) -> Array:
        """Return how points of links, (m, 3) in the world, move, shape (m, 3, size)."""
        stepper = self.stepper
        pose = stepper.dynamics().at(stepper.law.angles, stepper.world_body.base_pose())
        arms = points[:, np.newaxis] - pose.origins[np.newaxis, 1:]
        crosses = skew_matrices(pose.axes)
        moved = np.einsum("nij,mnj->min", crosses, arms)
        moved *= pose.chain.moved_by[links][:, np.newaxis]
        return self._with_base(moved, points - pose.centres[0])

    def _with_base(self, moved: Array, arms: Array) -> Array:
        """Return a Jacobian of joints, with what the base adds; `arms` reach from its centre."""
        del arms
        return moved

    def response(self, forces: Array) -> Array:
        """Return the accelerations, (size, k), that generalised forces, (size, k), bring."""
        brought: Array = self.stepper.law.response.dot(forces)
        return brought

    def angles(self) -> Array:
        """Return the joint angles, shape (joints,)."""
        return self.stepper.law.angles.copy()

    def observe(self) -> None:
        """Take the present motion: the law has it."""

    def write(self, now: Array, coming: Array) -> None:
        """Fill in the coordinates now, and at the end of the coming step, (size,) each."""
        law = self.stepper.law
        now[:] = law.rates
        np.multiply(law.predicted, law.time_step, coming)
        coming += law.rates


class JointsOnMovedBase(Joints):
    """Joints, then the base, which moves as its path says, whatever touches it."""

    def __init__(self, stepper: BodyStepper, base: PrescribedBase) -> None:
        super().__init__(stepper)
        self._base = base
        self.size = self.joints + 6

    def _with_base(self, moved: Array, arms: Array) -> Array:
        return np.concatenate([moved, _rigid(arms)], axis=2)

    def response(self, forces: Array) -> Array:
        """Return the accelerations, (size, k), that generalised forces, (size, k), bring."""
        still = np.zeros((6, forces.shape[1]))
        return np.concatenate([super().response(forces[: self.joints]), still])

    def write(self, now: Array, coming: Array) -> None:
        """Fill in the coordinates now, and at the end of the coming step, (size,) each."""
        n = self.joints
        super().write(now[:n], coming[:n])
        now[n:], coming[n:] = self._base.motion


class JointsOnFreeBase(Joints):
    """Joints, then a base that nothing holds, as it would move if the joints were still.

    With M_b the inertia of the base and M_bj its coupling to the joints, G = M_bj' M_b^-1, the
    base is given u = v_b + G' v, its momentum over its inertia: no torque of a joint changes it,
    the joints feel contact by J_j - J_b G', and the compliances of both add up.
    """

    has_fixed_coordinates = False  # G is that of the last Jacobian

    def __init__(self, stepper: BodyStepper) -> None:
        super().__init__(stepper)
        self._body = cast(WorldFreeBody, stepper.world_body)
        self.size = self.joints + 6
        self._inverse: Array = np.zeros((6, 6))
        self._coupling: Array = np.zeros((self.joints, 6))
        self._now: Array = np.zeros(6)
        self._before: Array = np.zeros(6)

    def _with_base(self, moved: Array, arms: Array) -> Array:
        inverse, coupling = self._body.base_response()
        axes = np.zeros((6, 6))
        axes[:3, :3] = axes[3:, 3:] = self._body.base_inertial_pose().rotation
        self._inverse, self._coupling = axes @ inverse @ axes.T, coupling @ axes.T
        base = _rigid(arms)
        return np.concatenate([moved - base @ self._coupling.T, base], axis=2)

    def response(self, forces: Array) -> Array:
        """Return the accelerations, (size, k), that generalised forces, (size, k), bring."""
        n = self.joints
        return np.concatenate([super().response(forces[:n]), self._inverse @ forces[n:]])

    def observe(self) -> None:
        """Take the present motion of the base."""
        velocity, spin = self._body.base_velocity()
        self._before, self._now = self._now, np.array([*spin, *velocity])

    def write(self, now: Array, coming: Array) -> None:
        """Fill in the coordinates now, and at the end of the coming step, (size,) each."""
        n, law = self.joints, self.stepper.law
        super().write(now[:n], coming[:n])
        now[n:] = self._now + law.rates @ self._coupling
        change = self._now - self._before + (law.rates - law.previous_rates) @ self._coupling
        np.add(now[n:], change, coming[n:])


class Object:
    """An object: free, or one that moves as it is told, whatever touches it."""

    joints = 0
    size = 6
    has_fixed_coordinates = True

    def __init__(self, world_object: WorldObject, is_free: bool) -> None:
        self._object = world_object
        self._velocity = world_object.velocity
        self.links_others = is_free
        self._inverse: Array = np.zeros((6, 6))
        self._now: Motion = (0.0,) * 6
        self._before: Motion = (0.0,) * 6

    def jacobian(self, links: Array, points: Array) -> Array:
        """Return how points of links, (m, 3) in the world, move, shape (m, 3, size)."""
        del links
        centre, self._inverse = self._object.mobility()
        return _rigid(points - centre)

    def response(self, forces: Array) -> Array:
        """Return the accelerations, (size, k), that generalised forces, (size, k), bring."""
        brought: Array = self._inverse @ forces
        return brought

    def angles(self) -> Array:
        """Return the joint angles, shape (0,)."""
        return np.zeros(0)

    def observe(self) -> None:
        """Take the present motion."""
        velocity, spin = self._velocity()
        self._before, self._now = self._now, (*spin, *velocity)

    def write(self, now: Array, coming: Array) -> None:
        """Fill in the coordinates now, and at the end of the coming step, (size,) each."""
        now[:] = self._now
        coming[:] = now
        if self.links_others:
            coming += now
            coming -= self._before


def coordinates_of(stepper: BodyStepper) -> Joints:
    """Return the coordinates of a body."""
    if isinstance(stepper.base, FloatingBase):
        return JointsOnFreeBase(stepper)
    if isinstance(stepper.base, PrescribedBase):
        return JointsOnMovedBase(stepper, stepper.base)
    return Joints(stepper)


def _rigid(arms: Array) -> Array:
    """Return how points move, (m, 3, 6), with the spin and the velocity of a rigid body's centre.

    `arms`, (m, 3), reach from the centre to the points.
    """
    jacobian: Array = np.zeros((len(arms), 3, 6))
    jacobian[:, :, :3] = -skew_matrices(arms)
    jacobian[:, :, 3:] = np.eye(3)
    return jacobian
