"""The external loads of a body as generalised forces."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.dynamics.load_torques import CarriedLoad, load_torques
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


class JointLoadTorques:
    """The torques of the loads of one body on its joints, for a base that is held or led."""

    def __init__(
        self, body: Body, loads: Sequence[LinkLoad], base_pose: Callable[[], Pose]
    ) -> None:
        self._base_pose = base_pose
        self._is_held = body.base == "static"
        # in the axes of the base, or of the link: force and moment, six numbers each
        self._wrenches = [np.concatenate([load.force, load.moment]) for load in loads]
        self._turns_with_link = [load.turns_with_link for load in loads]
        if self._is_held:
            self._wrenches = self._in_base_axes()
        self._numbers: list[list[float]] = [wrench.tolist() for wrench in self._wrenches]
        self._factors: list[float] = []
        self._parts: list[float] = []
        self._torques: Array = np.zeros(len(body.chain.joints))
        self._data = self._torques.data
        self._pack = struct.Struct(f"{len(body.chain.joints)}d").pack_into
        carried = [
            CarriedLoad(
                load.link,
                geometry.vector(load.point.tolist()),
                load.turns_with_link,
                self._possible_parts(load, wrench),
            )
            for load, wrench in zip(loads, self._wrenches, strict=True)
        ]
        self._function = load_torques(body.chain, carried)

    def at(self, factors: list[float], angles: Array) -> Array:
        """Return the torques, shape (n,), of loads times these factors."""
        if factors != self._factors or not self._is_held:
            self._factors = factors
            if not self._is_held:
                self._numbers = [wrench.tolist() for wrench in self._in_base_axes()]
            pairs = zip(factors, self._numbers, strict=True)
            self._parts = [factor * part for factor, wrench in pairs for part in wrench]
        try:
            torques = self._function(angles.tolist(), self._parts)
        except ValueError:  # an angle is infinite, which the divergence monitor reports
            self._torques[:] = np.nan
        else:
            self._pack(self._data, 0, *torques)
        return self._torques

    def _in_base_axes(self) -> list[Array]:
        """Return the wrenches, those that keep their direction in the present axes of the base."""
        axes = np.array(self._base_pose().rotation)
        return [
            wrench if turns else (wrench.reshape(2, 3) @ axes).reshape(6)
            for wrench, turns in zip(self._wrenches, self._turns_with_link, strict=True)
        ]

    def _possible_parts(
        self, load: LinkLoad, wrench: Array
    ) -> tuple[bool, bool, bool, bool, bool, bool]:
        """Return which parts can differ from zero: with a base that turns, all of a vector."""
        if self._is_held or load.turns_with_link:
            fx, fy, fz, mx, my, mz = (bool(part) for part in (wrench != 0).tolist())
            return (fx, fy, fz, mx, my, mz)
        force, moment = bool(load.force.any()), bool(load.moment.any())
        return (force, force, force, moment, moment, moment)


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
        self._body = body
        self._joint_torques: JointLoadTorques | None = None
        self._constant_factors: list[float] | None = None
        if all(signal.is_constant for signal in self._signals):
            self._constant_factors = [signal.at(0.0) for signal in self._signals]

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

    def joint_torques(self, time: float, angles: Array) -> Array:
        """Return the joint torques, shape (n,), of all loads at a time [s] and a pose.

        They are those of `force`, to rounding, several times faster. The array is used again.
        """
        if self._joint_torques is None:  # those of a free base are never asked for
            self._joint_torques = JointLoadTorques(self._body, self._loads, self._base_pose)
        factors = self._constant_factors or [signal.at(time) for signal in self._signals]
        return self._joint_torques.at(factors, angles)

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
