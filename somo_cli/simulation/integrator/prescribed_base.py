"""A body whose base is moved: its joints feel how the base accelerates and turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.scene.prescribed_motion import PosePath
from somo_cli.simulation.dynamics.chain_dynamics import ChainPose
from somo_cli.simulation.engine.interface import WorldPrescribedBody
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.motion_work_bound import MotionWorkBound
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.plan.model import Body, Plan

TURN = 0.3  # rad in a step: the engine is asked for five times as much, and reads angles by asin


class PrescribedBaseStepper(BodyStepper):
    """One body with a moved base; see `BodyStepper`.

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
        self._path = path
        self._contact_force = contact_force
        self._prescribed_body = world_body
        self._step = plan.time_step
        self._time = -1.0
        self._is_base_held = False  # whether the base was told to stay where it is
        self._centre = body.chain.links[0].inertial.centre
        self._goal = path.at(0.0)
        # of the base in the last step and in the coming one, shape (6,): spin, then velocity of
        # its centre of mass, in the world
        self._last_velocity = self._next_velocity = self._velocity_between(
            path.pose_before_start(plan.time_step), self._goal
        )
        self._start_velocity = (
            geometry.vector(self._next_velocity[3:]),
            geometry.vector(self._next_velocity[:3]),
        )
        self._work_bound = MotionWorkBound(plan, body.chain)
        self._checks_at_rest = 0
        self._last_energy = 0.0
        super().__init__(plan, body, world_body)
        self.reset_to_start()

    def actuate(self, time: float) -> None:
        """Set the actuation of a time [s], and have the base follow its path in the next step."""
        super().actuate(time)
        if time != self._time:  # time zero comes twice: the start is tried before the run
            goal = self._path.at(time + self._step)
            self._last_velocity, self._next_velocity = (
                self._next_velocity,
                self._velocity_between(self._goal, goal),
            )
            self._time, self._goal = time, goal
            self._check_turn()
            self._work_bound.advance(self._last_velocity, self._next_velocity)
        is_at_rest = not self._next_velocity.any()
        # told anew, a base at rest would be moved by rounding, wherever a row happens to fall
        if not (is_at_rest and self._is_base_held):
            self._prescribed_body.move_base(self._goal, is_at_rest)
        self._is_base_held = is_at_rest

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which `actuate` changes nothing after `time`."""
        if self._last_velocity.any() or self._next_velocity.any():
            return time  # a base that is to rest from now on has come to rest one step later
        return min(super().constant_until(time), self._path.stationary_until(time, self._step))

    def set_start_force(self, force: Array, rates: Array) -> None:
        """Take the force on the joints that was measured at the start, at these rates."""
        spin = self._last_velocity[:3].tolist()
        bias = self.world_body.bias(self.law.angles.tolist(), rates.tolist(), spin)
        self.law.set_force(force, bias + self._base_torques())

    def reset_to_start(
        self,
        rates: Sequence[float] | None = None,
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        """Put the body back to its start, the base as fast as it was half a step before."""
        super().reset_to_start(rates, self._start_velocity)

    @property
    def base_motion(self) -> tuple[Array, Array]:
        """Motion of the base, (6,), in the last step and the coming one: spin, then velocity."""
        return self._last_velocity, self._next_velocity

    def _velocity_between(self, first: Pose, second: Pose) -> Array:
        """Return the velocity that leads from one pose of the base to the next in a step."""
        turn = geometry.multiply(second.rotation, geometry.transposed(first.rotation))
        way = geometry.subtract(second.point(self._centre), first.point(self._centre))
        return np.array([*geometry.rotation_vector(turn), *way]) / self._step

    def _check_turn(self) -> None:
        turn = float(np.linalg.norm(self._next_velocity[:3])) * self._step
        if turn > TURN:
            raise EngineRefused(
                self.body.name,
                f"its motion turns the base by {turn:.3g} rad in the step at {self._time:g} s, and "
                f"the engine can follow {TURN:g}; take a smaller time step",
            )

    def _base_torques(self) -> Array:
        """Return the joint torques that the coming acceleration of the base asks for."""
        return self._prescribed_body.base_acceleration_torques(
            (self._next_velocity - self._last_velocity) / self._step
        )

    def _pose(self) -> ChainPose:
        return self.dynamics().at(self.law.angles, self.world_body.base_pose())

    def _reuse_steps(self, change: Array) -> int:
        is_at_rest = not (self._last_velocity.any() or self._next_velocity.any())
        self._checks_at_rest = self._checks_at_rest + 1 if is_at_rest else 0
        next_check = self._time + MONITORING_INTERVAL * self._step
        is_resting = self._path.stationary_until(self._time, self._step) > next_check
        return super()._reuse_steps(change) if self._checks_at_rest > 1 and is_resting else 1

    def _predict_corrected(self) -> None:
        law, world = self.law, self.world_body
        angles = law.angles.tolist()
        # at the instant of the angles the base is half a step on
        spin = (0.5 * (self._last_velocity[:3] + self._next_velocity[:3])).tolist()
        base_torques = self._base_torques()
        centre = world.base_inertial_pose()
        present = world.bias(angles, law.rates.tolist(), self._last_velocity[:3].tolist(), centre)
        if law.bias is None:  # the last step was one of a base at rest
            law.bias = present
        law.predict(
            present + base_torques,
            lambda rates: world.bias(angles, rates.tolist(), spin, centre) + base_torques,
        )

    def _update_energy(self) -> None:
        super()._update_energy()  # in the frame of the base
        energy = self.energy
        energy.add_energy(self._work_bound.frame_work(max(energy.present, self._last_energy)))
        self._last_energy = energy.present
        if self._work_bound.can_touch:
            energy.add_energy(self._work_bound.contact_work(self._contact_force()))
