"""An object with prescribed motion: it follows its path, whatever it touches."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.prescribed_motion import PosePath
from somo_cli.simulation.engine.interface import WorldKinematicObject
from somo_cli.simulation.integrator.motion_work_bound import MotionWorkBound
from somo_cli.simulation.plan.model import Plan, PlannedObject


class KinematicObjectStepper:
    """Steps one object along its path.

    `contact_force` returns the contact force on it and its sum of normal forces.
    """

    def __init__(
        self,
        plan: Plan,
        planned: PlannedObject,
        path: PosePath,
        world_object: WorldKinematicObject,
        contact_force: Callable[[], Sequence[float]],
    ) -> None:
        self._path = path
        self._object = world_object
        self._contact_force = contact_force
        self._step = plan.time_step
        self._time = -1.0
        self._goal = path.at(0.0)
        self._velocity: Array = np.zeros(6)
        self._steps_at_rest = 0  # in a row
        self._work_bound = MotionWorkBound(plan, planned.rigid_object.chain)
        self._energy_bound = 0.0

    def actuate(self, time: float) -> None:
        """Have the object follow its path in the step that starts at a time [s]."""
        if time != self._time:  # time zero comes twice: the start takes trial steps
            goal = self._path.at(time + self._step)
            velocity = self._velocity_between(self._goal, goal)
            self._work_bound.advance(self._velocity, velocity)
            self._time, self._goal, self._velocity = time, goal, velocity
            self._steps_at_rest = 0 if velocity.any() else self._steps_at_rest + 1
        # the first step at rest makes up for the rounding of the last move; setting the pose of an
        # object at rest again would move it by rounding, depending on where rows fall
        if self._steps_at_rest < 2:
            self._object.move_to(self._goal, self._step)
        elif self._steps_at_rest == 2:
            self._object.hold_pose()

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which `actuate` changes nothing after `time`."""
        if self._steps_at_rest < 2:
            return time
        return self._path.stationary_until(time, self._step)

    def energy_bound(self) -> float:
        """Return an upper bound on the energy that the object has put in so far."""
        self._energy_bound += self._work_bound.contact_work(self._contact_force())
        return self._energy_bound

    @property
    def energy_so_far(self) -> float:
        """The bound as it was when `energy_bound` was last asked for."""
        return self._energy_bound

    def _velocity_between(self, first: Pose, second: Pose) -> Array:
        turn = geometry.multiply(second.rotation, geometry.transposed(first.rotation))
        way = geometry.subtract(second.position, first.position)
        return np.array([*geometry.rotation_vector(turn), *way]) / self._step
