"""The external loads of one body as generalised forces, and the work that they do."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.plan import Body, Load
from somo_cli.simulation.springs import Array

_Wrench: TypeAlias = tuple[Array, Array, Array, Array]
"""Where it acts, the axes of its link as columns, force and moment; in the world, at factor one."""


class BodyLoads:
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
        self._turns_with_link = [load.frame == "body" for load in body.loads]
        self._signals = [load.signal for load in body.loads]
        self._factors = [0.0] * len(body.loads)
        self._nothing: Array = np.zeros(6 + self._chain.count)
        self._before: list[_Wrench] = []

    def force(self, time: float, angles: Array) -> Array:
        """Return the generalised force, shape (6 + n,), of all loads at a time [s] and a pose.

        As `ChainPose.force_on` gives it. What is not loaded costs no pose.
        """
        self._factors = [signal.at(time) for signal in self._signals]
        if not any(self._factors):
            return self._nothing
        pose = self._chain.at(angles, self._base_pose())
        total = self._nothing
        for index, factor in enumerate(self._factors):
            if factor != 0:
                point, _, force, moment = self._wrench(pose, index)
                link = self._loads[index][0]
                total = total + pose.force_on(link, point, factor * force, factor * moment)
        return total

    def steady_until(self, time: float) -> float:
        """Return the time [s] up to which no load acts, or `time` if one does.

        A load that is constant is steady only while it is zero: what it does depends on the pose.
        """
        if any(signal.at(time) != 0 for signal in self._signals):
            return time
        return min(signal.steady_until(time) for signal in self._signals)

    def work(self, angles: Array) -> float:
        """Return the work of the loads since the last call, by the trapezoidal rule.

        They are as large as in the last call of `force` on all of the way, as in a step; the first
        call returns zero.
        """
        pose = self._chain.at(angles, self._base_pose())
        now = [self._wrench(pose, index) for index in range(len(self._loads))]
        work = 0.0
        for factor, before, after in zip(self._factors, self._before, now, strict=False):
            if factor != 0:
                work += 0.5 * factor * float((before[2] + after[2]) @ (after[0] - before[0]))
                turned = _turn(after[1] @ before[1].T)
                work += 0.5 * factor * float((before[3] + after[3]) @ turned)
        self._before = now
        return work

    def _wrench(self, pose: ChainPose, index: int) -> _Wrench:
        link, point, force, moment = self._loads[index]
        axes = pose.rotations[link]
        if self._turns_with_link[index]:
            force, moment = axes @ force, axes @ moment
        return pose.point(link, point), axes, force, moment


def generalised(load: Load, pose: ChainPose) -> Array:
    """Return the generalised force, shape (6 + n,), of a load at a pose, its factor being one."""
    force, moment = np.array(load.force), np.array(load.moment)
    if load.frame == "body":
        axes = pose.rotations[load.link]
        force, moment = axes @ force, axes @ moment
    return pose.force_on(load.link, pose.point(load.link, load.point), force, moment)


def stiffness_of(load: Load, pose: ChainPose, factor: float) -> Array:
    """Return the joint stiffness, (n, n), of a force that keeps its direction; else zero.

    A force or moment that turns with its link, and a moment, have no potential; their stiffness
    is not symmetric, and left out.
    """
    force = factor * np.array(load.force if load.frame == "world" else (0.0, 0.0, 0.0))
    return pose.stiffness_of_force(load.link, pose.point(load.link, load.point), force)


def _turn(rotation: Array) -> Array:
    """Return the rotation vector [rad], shape (3,), of a rotation matrix."""
    rows = rotation.tolist()
    x, y, z, w = geometry.quaternion_from_rotation((tuple(rows[0]), tuple(rows[1]), tuple(rows[2])))
    sine = math.hypot(x, y, z)
    angle = 2 * math.atan2(sine, abs(w))
    scale = math.copysign(angle / sine, w) if sine > 0 else 0.0
    return np.array([scale * x, scale * y, scale * z])
