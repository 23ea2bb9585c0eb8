"""The external loads of one body as generalised forces."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.plan.model import Body, PlannedLoad

_WorldLoad: TypeAlias = tuple[Array, Array, Array]
"""Where it acts, force and moment; in the world, at a factor of one."""


class ExternalLoads:
    """The loads of one body; `base_pose` tells where its base frame is, if it can move.

    In the units of the engine, vectors in the world frame.
    """

    def __init__(self, body: Body, base_pose: Callable[[], Pose]) -> None:
        self._chain = ChainDynamics(body.chain)
        self._base_pose = base_pose
        if body.base == "static":
            held = body.start.pose
            self._base_pose = lambda: held
        self._loads = [
            (load.link, np.array(load.point), np.array(load.force), np.array(load.moment))
            for load in body.loads
        ]
        self._is_in_link_frame = [load.frame == "body" for load in body.loads]
        self._signals = [load.signal for load in body.loads]
        self._zero_force: Array = np.zeros(6 + self._chain.count)

    def force(self, time: float, angles: Array) -> Array:
        """Return the generalised force, shape (6 + n,), of all loads at a time [s] and a pose.

        As `ChainPose.generalised_force` gives it. What is not loaded costs no pose.
        """
        factors = [signal.at(time) for signal in self._signals]
        if not any(factors):
            return self._zero_force
        pose = self._chain.at(angles, self._base_pose())
        total = self._zero_force
        for index, factor in enumerate(factors):
            if factor != 0:
                point, force, moment = self._world_load(pose, index)
                link = self._loads[index][0]
                total = total + pose.generalised_force(link, point, factor * force, factor * moment)
        return total

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which no load acts, or `time` if one does.

        A load that is constant is steady only while it is zero: what it does depends on the pose.
        """
        if any(signal.at(time) != 0 for signal in self._signals):
            return time
        return min(signal.constant_until(time) for signal in self._signals)

    def _world_load(self, pose: ChainPose, index: int) -> _WorldLoad:
        link, point, force, moment = self._loads[index]
        axes = pose.rotations[link]
        if self._is_in_link_frame[index]:
            force, moment = axes @ force, axes @ moment
        return pose.point(link, point), force, moment


def generalised_load_force(load: PlannedLoad, pose: ChainPose) -> Array:
    """Return the generalised force, shape (6 + n,), of a load at a pose, its factor being one."""
    force, moment = np.array(load.force), np.array(load.moment)
    if load.frame == "body":
        axes = pose.rotations[load.link]
        force, moment = axes @ force, axes @ moment
    return pose.generalised_force(load.link, pose.point(load.link, load.point), force, moment)


def load_stiffness(load: PlannedLoad, pose: ChainPose, factor: float) -> Array:
    """Return the joint stiffness, (n, n), of a force that keeps its direction; else zero.

    A force or moment that turns with its link, and a moment, have no potential; their stiffness
    is not symmetric, and left out.
    """
    force = factor * np.array(load.force if load.frame == "world" else (0.0, 0.0, 0.0))
    return pose.force_stiffness(load.link, pose.point(load.link, load.point), force)
