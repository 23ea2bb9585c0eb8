"""Collect the state of a scene at time zero as a keyframe of MJCF."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

from somo_cli.exchange.xml_text import numbers
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.model import Manipulator
from somo_cli.scene.quantities import channels
from somo_cli.scene.rigid_object import RigidObject
from somo_cli.scene.signals import piecewise_signal


@dataclass(slots=True)
class StartState:
    """Positions, velocities and controls in the order of the model."""

    qpos: list[float] = field(default_factory=list)
    qvel: list[float] = field(default_factory=list)
    ctrl: list[float] = field(default_factory=list)

    def add_manipulator(self, one: Manipulator, is_free: bool) -> None:
        """Append the base, if it is free, the joints and the controls of a manipulator."""
        if is_free:
            self._add_free(one.pose, one.linear_velocity, one.angular_velocity)
        self.qpos += one.initial_angles
        self.qvel += one.initial_rates
        for channel in channels(one.compiled.chain):
            self.ctrl.append(
                sum(
                    entry.profile.signal().at(0.0)
                    for entry in one.actuation
                    if (entry.actuator, entry.axis) == channel
                )
            )
        for load in one.loads:
            factor = piecewise_signal(load.waypoints, load.interpolation, load.repeat)
            self.ctrl.append(factor.at(0.0))

    def add_object(self, one: RigidObject) -> None:
        """Append a free object, whose velocity is given at its centre of mass."""
        centre = geometry.rotate(one.pose.rotation, one.chain.links[0].inertial.centre)
        spin = geometry.cross(one.angular_velocity, centre)
        self._add_free(one.pose, geometry.subtract(one.linear_velocity, spin), one.angular_velocity)

    def _add_free(self, pose: Pose, velocity: Vector, spin: Vector) -> None:
        """Append a free joint: its velocity is that of the origin, its spin in its own axes."""
        x, y, z, w = geometry.quaternion_from_rotation(pose.rotation)
        self.qpos += [*pose.position, w, x, y, z]
        self.qvel += [*velocity, *geometry.rotate(geometry.transposed(pose.rotation), spin)]

    def add_key(self, root: ET.Element) -> None:
        """Add the key `start` to a model."""
        values = (("qpos", self.qpos), ("qvel", self.qvel), ("ctrl", self.ctrl))
        attributes = {name: numbers(value) for name, value in values if value}
        if attributes:
            ET.SubElement(ET.SubElement(root, "keyframe"), "key", {"name": "start", **attributes})
