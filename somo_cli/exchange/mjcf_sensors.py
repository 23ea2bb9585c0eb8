"""Write a sensor for each quantity that a scene records and MuJoCo can read."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass

from somo_cli.exchange.mjcf_bodies import tip_name
from somo_cli.manipulator.chain import Chain
from somo_cli.scene.columns import Recorded, column_groups
from somo_cli.scene.quantities import channel_names

_XYZ, _XYZW = "xyz", ("qx", "qy", "qz", "qw")


@dataclass(frozen=True, slots=True)
class _Sensor:
    """A sensor: its name, its tag and attributes, and the start of the columns that it stands for.

    A quaternion of MuJoCo has its real part first, and that of a column has it last.
    """

    name: str
    columns: str
    tag: str
    attributes: dict[str, str]


def add_sensors(root: ET.Element, recorded: Recorded) -> None:
    """Add the sensors of all recorded quantities that MuJoCo can read; their units are SI."""
    selected = [name for group in column_groups(recorded) for name in group.selection.names]
    section = ET.SubElement(root, "sensor")
    for sensor in (*_of_manipulators(recorded), *_of_objects(recorded)):
        if any(name.startswith(sensor.columns) for name in selected):
            ET.SubElement(section, sensor.tag, {"name": sensor.name, **sensor.attributes})
    if len(section) == 0:
        root.remove(section)


_READ = {
    "joint_angles",
    "joint_rates",
    "actuation",
    "link_positions",
    "link_orientations",
    "base_pose",
    "tip_position",
    "tip_velocity",
    "tip_orientation",
    "bending_angles",
    "contact_force",
    "pose",
    "velocity",
}
"""The quantities that have sensors; the energy has one where it is that of the whole model."""


def unread_quantities(recorded: Recorded) -> list[str]:
    """Return the recorded quantities for which there is no sensor."""
    read = {*_READ, "energy"} if _is_alone(recorded) else _READ
    return sorted({*recorded.quantities, *recorded.object_quantities} - read)


def _is_alone(recorded: Recorded) -> bool:
    """Whether the energy of the whole model is that of its only manipulator."""
    return len(recorded.manipulators) == 1 and not recorded.objects


def _of_manipulators(recorded: Recorded) -> Iterator[_Sensor]:
    for owner, chain in recorded.manipulators:
        prefix = f"{owner}."
        yield from _of_joints(recorded, chain, prefix)
        yield from _of_poses(recorded, chain, prefix)
        if "energy" in recorded.quantities and _is_alone(recorded):
            energy = f"{prefix}energy"
            yield _Sensor(f"{energy}.kinetic_j", f"{energy}.kinetic_j", "e_kinetic", {})
            yield _Sensor(f"{energy}.potential_j", f"{energy}.elastic_j", "e_potential", {})
        if "contact_force" in recorded.quantities:
            yield _contact(owner, {"subtree1": prefix + chain.links[0].name})


def _of_poses(recorded: Recorded, chain: Chain, prefix: str) -> Iterator[_Sensor]:
    kinds = {
        "link_positions": ("framepos", "position_m", "x_m"),
        "link_orientations": ("framequat", "orientation_wxyz", "qx"),
    }
    for quantity, (tag, unit, first) in kinds.items():
        for link in chain.links if quantity in recorded.quantities else ():
            yield _pose(prefix + link.name, tag, prefix + link.name, unit, first)
        if "base_pose" in recorded.quantities:
            base = prefix + chain.links[0].name
            yield _pose(prefix + "base_pose", tag, base, unit, first)
    yield from _of_tips(recorded, chain, prefix)


def _of_tips(recorded: Recorded, chain: Chain, prefix: str) -> Iterator[_Sensor]:
    kinds = {
        "tip_position": ("", "framepos", "position_m", "x_m"),
        "tip_velocity": ("_velocity", "framelinvel", "m_per_s", "x_m_per_s"),
        "tip_orientation": ("_orientation", "framequat", "wxyz", "qx"),
    }
    for quantity, (suffix, tag, unit, first) in kinds.items():
        for limb in chain.backbones if quantity in recorded.quantities else ():
            site = tip_name(prefix, limb.prefix)
            start = f"{site}{suffix}"
            target = {"objtype": "site", "objname": site}
            yield _Sensor(f"{start}.{unit}", f"{start}.{first}", tag, target)


def _of_joints(recorded: Recorded, chain: Chain, prefix: str) -> Iterator[_Sensor]:
    tags = {
        "joint_angles": ("angle_rad", "jointpos"),
        "joint_rates": ("rate_rad_per_s", "jointvel"),
    }
    for quantity, (unit, tag) in tags.items():
        for joint in chain.joints if quantity in recorded.quantities else ():
            name = f"{prefix}{joint.name}.{unit}"
            yield _Sensor(name, name, tag, {"joint": prefix + joint.name})
    for channel in channel_names(chain) if "actuation" in recorded.quantities else ():
        name = f"{prefix}{channel}.torque_nm"
        yield _Sensor(name, name, "actuatorfrc", {"actuator": prefix + channel})
    for channel in channel_names(chain) if "bending_angles" in recorded.quantities else ():
        name = f"{prefix}{channel}.bend_rad"  # the length of the tendon: the sum of the angles
        yield _Sensor(name, name, "tendonpos", {"tendon": prefix + channel})


def _of_objects(recorded: Recorded) -> Iterator[_Sensor]:
    for owner in recorded.objects:
        if "pose" in recorded.object_quantities:
            yield _pose(f"{owner}.pose", "framepos", owner, "position_m", "x_m")
            yield _pose(f"{owner}.pose", "framequat", owner, "orientation_wxyz", "qx")
        if "velocity" in recorded.object_quantities:
            centre = {"objtype": "body", "objname": owner}
            start = f"{owner}.velocity"
            yield _Sensor(f"{start}.m_per_s", f"{start}.x_m_per_s", "framelinvel", centre)
            start = f"{owner}.spin"
            yield _Sensor(f"{start}.rad_per_s", f"{start}.x_rad_per_s", "frameangvel", centre)
        if "contact_force" in recorded.object_quantities:
            yield _contact(owner, {"body1": owner})


def _pose(start: str, tag: str, body: str, unit: str, first: str) -> _Sensor:
    """Return the sensor of the frame of a body, not of its centre of mass."""
    return _Sensor(
        f"{start}.{unit}", f"{start}.{first}", tag, {"objtype": "xbody", "objname": body}
    )


def _contact(owner: str, of: dict[str, str]) -> _Sensor:
    """Return the sensor of the sum of all contact forces on a body, in the world's axes."""
    attributes = {**of, "reduce": "netforce", "data": "force"}
    return _Sensor(f"{owner}.contact.force_n", f"{owner}.contact.f", "contact", attributes)
