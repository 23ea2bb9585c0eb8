"""A base with prescribed motion: its joints feel how it accelerates and turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.scene.prescribed_motion import PosePath
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.engine.interface import WorldPrescribedBody
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.integrator.fixed_base import FixedBase
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.motion_work_bound import MotionWorkBound
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.plan.model import Body, Plan

MAX_TURN = 0.3  # rad in a step: the engine gets five times as much, and reads angles by asin


class PrescribedBase(FixedBase):
    """A base that follows its path.

    The base is where its path says at every step, so its velocity at half steps is the difference
    of two poses over the step, and its acceleration that of two velocities. Both are known before
    the step: what the joints feel of them need not be measured, it is part of the bias. The body
    starts with the velocity of its path. `contact_force` returns the contact force on the body.
    """

    def __init__(
        self,
        plan: Plan,
        body: Body,
        world_body: WorldPrescribedBody,
        path: PosePath,
        contact_force: Callable[[], Sequence[float]],
    ) -> None:
        super().__init__(body, world_body)
        self._path = path
        self._contact_force = contact_force
        self._prescribed_body = world_body
        self._step = plan.time_step
        self._time = -1.0  # of the step whose motion is set
        self._is_held = False  # whether the engine holds the base where it is
        self._centre = body.chain.links[0].inertial.centre
        self._goal = path.at(0.0)
        # of the base in the last step and in the coming one, shape (6,): spin, then velocity of
        # its centre of mass, in the world
        self._last_velocity = self._next_velocity = self._velocity_between(
            path.pose_before_start(plan.time_step), self._goal
        )
        self.start_velocity = (
            geometry.vector(self._next_velocity[3:]),
            geometry.vector(self._next_velocity[:3]),
        )
        self._work_bound = MotionWorkBound(plan, body.chain)
        self._checks_at_rest = 0
        self._last_energy = 0.0

    @property
    def motion(self) -> tuple[Array, Array]:
        """Motion of the base, (6,), in the last step and the coming one: spin, then velocity."""
        return self._last_velocity, self._next_velocity

    @property
    def _is_at_rest(self) -> bool:
        return not (self._last_velocity.any() or self._next_velocity.any())

    def actuate(self, time: float) -> None:
        """Have the base follow its path in the step that starts at a time [s].

        Raises EngineRefused if it turns farther in the step than the engine can follow.
        """
        if time != self._time:  # time zero comes twice: the start is tried before the run
            goal = self._path.at(time + self._step)
            self._last_velocity, self._next_velocity = (
                self._next_velocity,
                self._velocity_between(self._goal, goal),
            )
            self._time, self._goal = time, goal
            self._check_turn()
            self._work_bound.advance(self._last_velocity, self._next_velocity)
        will_rest = not self._next_velocity.any()
        # set anew, the goal of a base at rest would move it by rounding, wherever a row falls
        if not (will_rest and self._is_held):
            self._prescribed_body.move_base(self._goal, will_rest)
        self._is_held = will_rest

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which the base moves as it does at `time`."""
        if not self._is_at_rest:
            return time  # a base that is to rest from now on has come to rest one step later
        return self._path.stationary_until(time, self._step)

    def start_bias(self, law: SpringDamperLaw, rates: Array) -> Array:
        """Return the bias forces on the joints at the start, shape (n,), at these rates."""
        spin = self._last_velocity[:3].tolist()
        bias = self.world_body.bias(law.angles.tolist(), rates.tolist(), spin)
        return bias + self._base_torques()

    def pose(self) -> Pose:
        """Return the present pose of the base frame."""
        return self.world_body.base_pose()

    def can_reuse_correction(self) -> bool:
        """Whether the base was at rest at two checks, and stays so until the next."""
        self._checks_at_rest = self._checks_at_rest + 1 if self._is_at_rest else 0
        next_check = self._time + MONITORING_INTERVAL * self._step
        is_resting = self._path.stationary_until(self._time, self._step) > next_check
        return self._checks_at_rest > 1 and is_resting

    def predict(self, law: SpringDamperLaw) -> None:
        """Have the law predict the coming step, with what the joints feel of the base."""
        world, angles = self.world_body, law.angles.tolist()
        # at the instant of the angles the base is half a step on
        spin = (0.5 * (self._last_velocity[:3] + self._next_velocity[:3])).tolist()
        base_torques = self._base_torques()
        centre = world.base_inertial_pose()
        present = world.bias(angles, law.rates.tolist(), self._last_velocity[:3].tolist(), centre)
        if law.bias is None:  # the base was at rest in the last step
            law.bias = present
        law.predict(
            present + base_torques,
            lambda rates: world.bias(angles, rates.tolist(), spin, centre) + base_torques,
        )

    def update_energy(
        self, energy: BodyEnergy, law: SpringDamperLaw, dynamics: Callable[[], ChainDynamics]
    ) -> None:
        """Add the bounds on what the motion of the base has put in; energy is in its frame."""
        energy.add_energy(self._work_bound.frame_work(max(energy.present, self._last_energy)))
        self._last_energy = energy.present
        if self._work_bound.can_touch:
            energy.add_energy(self._work_bound.contact_work(self._contact_force()))

    def _velocity_between(self, first: Pose, second: Pose) -> Array:
        """Return the velocity that leads from one pose of the base to the next in a step."""
        turn = geometry.multiply(second.rotation, geometry.transposed(first.rotation))
        way = geometry.subtract(second.point(self._centre), first.point(self._centre))
        return np.array([*geometry.rotation_vector(turn), *way]) / self._step

    def _check_turn(self) -> None:
        turn = float(np.linalg.norm(self._next_velocity[:3])) * self._step
        if turn > MAX_TURN:
            raise EngineRefused(
                self.body.name,
                f"its motion turns the base by {turn:.3g} rad in the step at {self._time:g} s, and "
                f"the engine can follow {MAX_TURN:g}; take a smaller time step",
            )

    def _base_torques(self) -> Array:
        """Return the joint torques that the coming acceleration of the base asks for."""
        return self._prescribed_body.base_acceleration_torques(
            (self._next_velocity - self._last_velocity) / self._step
        )
