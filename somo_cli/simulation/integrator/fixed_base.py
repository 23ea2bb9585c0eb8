"""A base that stays where it is, and what a stepper asks of any base.

A stepper has one base, which knows how the base moves: what the joints feel of that, which loads
act on the base itself, and what its motion does to the energy. A floating and a prescribed base
differ from a fixed one in these methods alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.external_loads import ExternalLoads
from somo_cli.simulation.engine.interface import WorldBody
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.plan.model import Body

BaseVelocity: TypeAlias = tuple[Vector, Vector]
"""Velocity of the centre of mass of a base, and angular velocity, in the world."""


class FixedBase:
    """The base of one body, at rest: static in the engine, or held by a constraint."""

    energy_includes_base = False
    """Whether the energy is that of the whole body, in which the work of gravity is counted."""
    counts_load_power = False
    """Whether loads work on the base too, so that `load_power` counts all of their work."""

    def __init__(self, body: Body, world_body: WorldBody) -> None:
        self.body = body
        self.world_body = world_body
        self.apply: Callable[[Sequence[float]], None] = world_body.apply
        """Applies joint torques of the law, and what of the loads the law cannot know."""
        self.start_velocity: tuple[Vector, Vector] | None = None
        """Linear and angular velocity at the start, where they are not the scene's."""

    def reader(self, read_joints: Callable[[], None]) -> Callable[[], None]:
        """Return the function that reads the state of joints and base after a step."""
        return read_joints

    def actuate(self, time: float) -> None:
        """Set how the base moves in the step that starts at a time [s]."""

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the base moves as it does at `time`."""
        return math.inf

    def add_loads(
        self, loads: ExternalLoads, time: float, actuation: Array, law: SpringDamperLaw
    ) -> None:
        """Add loads at a time [s] to the actuation of the law."""
        np.add(actuation, loads.joint_torques(time, law.angles), law.actuation)

    def load_power(self, rates: Array) -> float:
        """Return the power of the loads on base and joints in the last step."""
        raise NotImplementedError("loads on a base at rest do no work")

    def start_bias(self, law: SpringDamperLaw, rates: Array) -> Array:
        """Return the bias forces on the joints at the start, shape (n,), at these rates."""
        spin = self.body.start.angular_velocity
        bias = self.world_body.bias(law.angles.tolist(), rates.tolist(), spin)
        return self.world_body.equivalent_joint_torques(bias)

    def velocity_half_step_before(
        self, law: SpringDamperLaw, before: BaseVelocity, after: BaseVelocity, rates_after: Array
    ) -> BaseVelocity:
        """Return the velocity of the base half a step before a start.

        `law` has the angles of the start and the joint rates half a step before it. A step of the
        engine led from the velocity `before` it, at the start, to those of base and joints `after`.
        """
        return _half_step_before(before[0], after[0]), _half_step_before(before[1], after[1])

    def mark_start(self) -> None:
        """Take the present state for that of the start, half a step before or at it."""

    def predict(self, law: SpringDamperLaw) -> None:
        """Have the law predict the coming step, with bias forces from the engine."""
        angles, world = law.angles.tolist(), self.world_body
        present = world.bias(angles, law.rates.tolist())
        law.predict(present, lambda rates: world.bias(angles, rates.tolist()))

    def finish(self, law: SpringDamperLaw, change: Array | None) -> None:
        """Apply the torques of the predicted step; `change` is what contact adds to a, (n,)."""
        self.world_body.apply(law.settle(change))

    def rate(self) -> float:
        """Return the angular velocity [rad/s] of a base that nothing holds or leads, else 0."""
        return 0.0

    def needs_fresh_inertia(self) -> bool:
        """Whether the inertia is to be that of the present angles, however little they moved."""
        return False

    def can_reuse_correction(self) -> bool:
        """Whether the motion of the base allows a correction to be reused; asked at each check."""
        return True

    def pose(self) -> Pose:
        """Return the pose of the base frame for which the body is linearized."""
        return self.body.start.pose

    def update_energy(
        self, energy: BodyEnergy, law: SpringDamperLaw, dynamics: Callable[[], ChainDynamics]
    ) -> None:
        """Add what the motion of the base changes to an energy that was just updated."""


def _half_step_before(before: Vector, after: Vector) -> Vector:
    x, y, z = (1.5 * one - 0.5 * other for one, other in zip(before, after, strict=True))
    return x, y, z
