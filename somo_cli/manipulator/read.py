"""Read the definition of a manipulator from a document without errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import elastic_link, geometry, joint_placement
from somo_cli.manipulator.definition import (
    ActuatorDefinition,
    Definition,
    JointDefinition,
    LinkDefinition,
    Material,
    WorldScale,
)
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.solids import Box, Cylinder, Solid, Sphere
from somo_cli.problems import Pointer

_GREY = (0.6, 0.6, 0.6, 1.0)


def read(document: Document, at: Pointer = ()) -> Definition:
    """Return the definition at a pointer of a document without errors."""
    data: Any = document.at(at)
    tips = data.get("tip_definitions") or []
    if data.get("tip_definition"):
        tips = [data["tip_definition"]]
    base = data.get("base_definition")
    return Definition(
        name=data["manipulator_name"],
        urdf_filename=filename(data),
        base=link_from(base) if base else None,
        actuators=tuple(_actuator(item) for item in data["actuator_definitions"]),
        tips=tuple(link_from(tip) for tip in tips),
    )


def filename(data: Mapping[str, Any]) -> str | None:
    """Return the file name in `urdf_filename`, without a folder; None without one."""
    return (data.get("urdf_filename") or "").replace("\\", "/").split("/")[-1] or None


def world_scale(document: Document, at: Pointer = ()) -> WorldScale:
    """Return the `world_scale` of the mapping at a pointer; None without one."""
    data: Any = document.at(at)
    value = data.get("world_scale")
    if value is None:
        return None
    if isinstance(value, Mapping):
        return Scale(float(value.get("length", 1)), float(value.get("mass", 1)))
    return Scale(float(value))


def link_from(data: Mapping[str, Any]) -> LinkDefinition:
    """Return the link from a mapping without errors.

    Without a mass it has that of its solid, of the density that is then given.
    """
    inertia = data.get("inertial_values")
    offset = data.get("origin_offset") or (0,) * 6
    rgba = data.get("material_color") or _GREY
    solid = solid_from(data["shape_type"], [float(value) for value in data["dimensions"]])
    mass = data.get("mass")
    return LinkDefinition(
        shape_type=data["shape_type"],
        solid=solid,
        mass=float(data["density"]) * solid.volume if mass is None else float(mass),
        inertia=None if inertia is None else _six(inertia),
        material=Material(data.get("material_name") or "grey", _four(rgba)),
        offset=geometry.vector(offset[:3]),
        offset_rpy=geometry.vector(offset[3:]),
        visual_factor=float(data.get("visual_geometry_scaling_factor") or 1.0),
    )


def solid_from(shape_type: str, dimensions: list[float]) -> Solid:
    """Return the solid with the mass of a link, from its shape and dimensions."""
    if shape_type in ("box", "stadium"):
        return Box(geometry.vector(dimensions))
    if shape_type in ("cylinder", "capsule"):
        return Cylinder(dimensions[0], dimensions[1])
    return Sphere(dimensions[0])


def _actuator(data: Mapping[str, Any]) -> ActuatorDefinition:
    link = link_from(data["link_definition"])
    items = data["joint_definitions"]
    count = int(data["n_segments"])
    is_alternating = int(data.get("planar_flag", 1 if len(items) == 1 else 0)) == 0
    span = link.height * (len(items) if is_alternating else 1)
    material = data["link_definition"]
    definitions = [_joint(item, _stiffness(item, material, link, span)) for item in items]
    turns = [index % len(definitions) for index in range(count)]
    return joint_placement.actuator_of(
        link,
        data.get("joint_placement", "uniform"),
        tuple(definitions[turn] for turn in turns),
        tuple(turns) if is_alternating else (0,) * count,
        len(definitions) if is_alternating else 1,
        float(data.get("taper") or 1.0),
    )


def joint_axis(data: Mapping[str, Any]) -> geometry.Vector:
    """Return the axis of a joint definition as it is given, x by default."""
    return geometry.vector(data.get("axis") or (1, 0, 0))


def _stiffness(
    joint: Mapping[str, Any], data: Mapping[str, Any], link: LinkDefinition, span: float
) -> float:
    """Return the stiffness that is given or, without one, that of the link's material, else 0."""
    given = joint.get("spring_stiffness")
    if given is None and data.get("modulus") is not None:
        return elastic_link.joint_stiffness(data, link.solid, joint_axis(joint), span)
    return float(given or 0)


def _joint(data: Mapping[str, Any], stiffness: float) -> JointDefinition:
    # a joint without limits has lower > upper, as URDF readers expect
    lower, upper, effort, velocity = data.get("limits") or (0.0, -1.0, 0.0, 0.0)
    if data["joint_type"] == "continuous":
        lower, upper = 0.0, -1.0
    offset = data.get("neutral_axis_offset") or (0,) * 6
    per_pressure = data.get("torque_per_pressure")
    return JointDefinition(
        joint_type=data["joint_type"],
        axis=joint_axis(data),
        lower=float(lower),
        upper=float(upper),
        effort=float(effort),
        velocity=float(velocity),
        stiffness=stiffness,
        damping=float(data.get("spring_damping") or 0),
        neutral_position=float(data.get("joint_neutral_position") or 0),
        friction=float(data.get("joint_control_limit_force") or 0),
        torque_per_pressure=None if per_pressure is None else float(per_pressure),
        offset=geometry.vector(offset[:3]),
    )


def _four(values: Any) -> tuple[float, float, float, float]:
    r, g, b, a = values
    return (float(r), float(g), float(b), float(a))


def _six(values: Any) -> tuple[float, float, float, float, float, float]:
    xx, xy, xz, yy, yz, zz = values
    return (float(xx), float(xy), float(xz), float(yy), float(yz), float(zz))
