"""The external loads of a body as generalised forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.plan.model import Body, PlannedLoad


@dataclass(frozen=True, slots=True)
class LinkLoad:
    """A force and a moment on a point of a link, as arrays, at a factor of one.

    The point is in the frame of the link. Force and moment are in that frame too if the load turns
    with the link, else in the world.
    """

    link: int
    point: Array
    force: Array
    moment: Array
    turns_with_link: bool

    @staticmethod
    def of(load: PlannedLoad) -> LinkLoad:
        """Return a planned load as arrays."""
        point, force, moment = (np.array(one) for one in (load.point, load.force, load.moment))
        return LinkLoad(load.link, point, force, moment, load.frame == "body")

    def generalised_force(self, pose: ChainPose, factor: float) -> Array:
        """Return its generalised force, shape (6 + n,), as `ChainPose.generalised_force` does."""
        force, moment = self.force, self.moment
        if self.turns_with_link:
            axes = pose.rotations[self.link]
            force, moment = axes @ force, axes @ moment
        point = pose.point(self.link, self.point)
        return pose.generalised_force(self.link, point, factor * force, factor * moment)


class ExternalLoads:
    """The loads of one body, in engine units and the world frame.

    `base_pose` returns the pose of its base frame, if that can move.
    """

    def __init__(self, body: Body, base_pose: Callable[[], Pose]) -> None:
        self._chain = ChainDynamics(body.chain)
        self._base_pose = base_pose
        if body.base == "static":
            held = body.start.pose
            self._base_pose = lambda: held
        self._loads = [LinkLoad.of(load) for load in body.loads]
        self._signals = [load.signal for load in body.loads]
        self._zero_force: Array = np.zeros(6 + self._chain.count)

    def force(self, time: float, angles: Array) -> Array:
        """Return the generalised force, shape (6 + n,), of all loads at a time [s] and a pose.

        As `ChainPose.generalised_force`. Without a load at that time no pose is computed.
        """
        factors = [signal.at(time) for signal in self._signals]
        if not any(factors):
            return self._zero_force
        pose = self._chain.at(angles, self._base_pose())
        total = self._zero_force
        for load, factor in zip(self._loads, factors, strict=True):
            if factor != 0:
                total = total + load.generalised_force(pose, factor)
        return total

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which no load acts, or `time` if one does.

        A constant load counts only while it is zero: its generalised force depends on the pose.
        """
        if any(signal.at(time) != 0 for signal in self._signals):
            return time
        return min(signal.constant_until(time) for signal in self._signals)


def generalised_load_force(load: PlannedLoad, pose: ChainPose) -> Array:
    """Return the generalised force, shape (6 + n,), of a load at a pose, its factor being one."""
    return LinkLoad.of(load).generalised_force(pose, 1.0)


def load_stiffness(load: PlannedLoad, pose: ChainPose, factor: float) -> Array:
    """Return the joint stiffness, (n, n), of a force that keeps its direction; else zero.

    Moments, and forces that turn with their link, have no potential; their stiffness is not
    symmetric and is left out.
    """
    force = factor * np.array(load.force if load.frame == "world" else (0.0, 0.0, 0.0))
    return pose.force_stiffness(load.link, pose.point(load.link, load.point), force)
