"""Make link and joint definitions, as data, of shapes, mass properties and joints."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from somo_cli.exchange.flat_model import FlatJoint
from somo_cli.exchange.split_limb import NotADefinitionError
from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Inertial, Sphere

Data = dict[str, Any]

SAME = 1e-9
"""Relative differences that are rounding."""
_SAFE = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]{0,63}")
_SHORT = 1e-13
"""How far, relatively, a number may be rounded to be shorter: exports do not round at all."""


def tidy(value: float, size: float = 0.0) -> float:
    """Return a number with as few digits as name it to rounding; `size` says what is zero."""
    if abs(value) <= _SHORT * size:
        return 0.0
    for digits in range(1, 17):
        short = float(f"{value:.{digits}g}")
        if abs(short - value) <= _SHORT * abs(value):
            return short
    return value


def link_data(
    shape: Shape, kind: str, inertial: Inertial, offset: Vector, size: float, scale: float
) -> Data:
    """Return the definition of a link with a solid.

    `inertial` is in the frame of the limb, and so is `offset`, the solid's distance from where the
    backbone has it. `size` is that of the model [m], `scale` the inertia in whose difference this
    one was found. Raises NotADefinitionError if the centre of mass is not that of the solid.
    """
    apart = geometry.norm(geometry.subtract(inertial.centre, shape.position))
    if apart > SAME * size:
        raise NotADefinitionError(
            f"a centre of mass is {apart:.3g} away from the middle of its shape, "
            "where a definition has it"
        )
    data: Data = {
        "shape_type": kind,
        "dimensions": [tidy(one) for one in dimensions(shape.solid)],
        "mass": tidy(inertial.mass),
    }
    rotation = geometry.rotation_from_rpy(shape.rpy)
    own = geometry.rotated_tensor(inertial.inertia, geometry.transposed(rotation))
    homogeneous = shape.solid.inertia(inertial.mass)  # type: ignore[union-attr]
    tolerance = SAME * max(homogeneous) + 1e-12 * scale
    if max(abs(a - b) for a, b in zip(own, homogeneous, strict=True)) > tolerance:
        data["inertial_values"] = [tidy(one, max(own) + scale) for one in own]
    data["material_color"] = list(shape.material.rgba)
    if _SAFE.fullmatch(shape.material.name):
        data["material_name"] = shape.material.name
    if shape.visual_factor != 1:
        data["visual_geometry_scaling_factor"] = tidy(shape.visual_factor)
    place = [tidy(one, size) for one in offset] + [tidy(one, 1.0) for one in shape.rpy]
    if any(place):
        data["origin_offset"] = place
    return data


def dimensions(solid: AnySolid) -> list[float]:
    """Return the dimensions of a solid as a definition has them."""
    if isinstance(solid, Box):
        return list(solid.size)
    if isinstance(solid, Cylinder):
        return [solid.length, solid.radius]
    assert isinstance(solid, Sphere)
    return [solid.radius]


def with_height(solid: AnySolid, height: float) -> AnySolid:
    """Return a solid of the same cross-section at another height; a sphere changes as a whole."""
    if isinstance(solid, Box):
        return Box((solid.size[0], solid.size[1], height))
    return Cylinder(height, solid.radius) if isinstance(solid, Cylinder) else Sphere(height / 2)


def kind_of(solid: AnySolid, is_rounded: bool) -> str:
    """Return the `shape_type` of a solid, whose hinges or ends may be rounded."""
    if isinstance(solid, Box):
        return "stadium" if is_rounded else "box"
    if isinstance(solid, Cylinder):
        return "capsule" if is_rounded else "cylinder"
    return "sphere"


def joint_data(joint: FlatJoint, offset: Vector, size: float) -> Data:
    """Return the definition of a joint; `offset` is its distance from the backbone."""
    data: Data = {"joint_type": "revolute" if joint.is_limited else "continuous"}
    data["axis"] = [tidy(one, 1.0) for one in joint.axis]
    if joint.is_limited:
        four = (joint.lower, joint.upper, joint.effort, joint.velocity)
        data["limits"] = [tidy(one) for one in four]
    data["spring_stiffness"] = tidy(joint.stiffness)
    data["spring_damping"] = tidy(joint.damping)
    if joint.neutral_position:
        data["joint_neutral_position"] = tidy(joint.neutral_position)
    if joint.friction:
        data["joint_control_limit_force"] = tidy(joint.friction)
    place = [tidy(one, size) for one in offset]
    if any(abs(one) > SAME * size for one in place):
        data["neutral_axis_offset"] = [*place, 0.0, 0.0, 0.0]
    return data


def are_same(one: Mapping[str, Any], other: Mapping[str, Any], size: float = 1.0) -> bool:
    """Whether two definitions are equal to rounding."""
    return one.keys() == other.keys() and all(_is_same(one[key], other[key], size) for key in one)


def _is_same(one: Any, other: Any, size: float) -> bool:
    if isinstance(one, Sequence) and not isinstance(one, str):
        return len(one) == len(other) and all(map(_is_same, one, other, [size] * len(one)))
    if isinstance(one, float | int):
        return math.isclose(one, other, rel_tol=SAME, abs_tol=1e-12 * size)
    return bool(one == other)


def difference(whole: Inertial, part: Inertial) -> Inertial:
    """Return what is left of a rigid body without a part, about its own centre of mass.

    Raises NotADefinitionError if nothing is left.
    """
    mass = whole.mass - part.mass
    if mass <= SAME * whole.mass:
        raise NotADefinitionError("a base or tip would have no mass")
    x, y, z = (
        (whole.mass * a - part.mass * b) / mass
        for a, b in zip(whole.centre, part.centre, strict=True)
    )
    centre = (x, y, z)
    total = [
        a + b - c - d
        for a, b, c, d in zip(
            whole.inertia,
            geometry.point_mass_inertia(whole.mass, geometry.subtract(whole.centre, centre)),
            part.inertia,
            geometry.point_mass_inertia(part.mass, geometry.subtract(part.centre, centre)),
            strict=True,
        )
    ]
    return Inertial(mass, centre, (total[0], total[1], total[2], total[3], total[4], total[5]))


def part_of(shape: Shape, full: Inertial, full_solid: AnySolid, fraction: float) -> Inertial:
    """Return mass properties of a segment: a fraction of a link, whose inertia is in its axes."""
    assert isinstance(full_solid, Box | Cylinder | Sphere)
    tensor = solids.shortened_inertia(full_solid, full.inertia, fraction)
    own = Inertial(full.mass * fraction, geometry.ZERO, tensor)
    return solids.placed(own, shape.position, geometry.rotation_from_rpy(shape.rpy))
