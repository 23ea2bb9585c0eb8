"""Write the shapes of a link as geoms of MJCF."""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from somo_cli.exchange.xml_text import numbers, pose_attributes
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Link, Shape
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Sphere

_HIDDEN_GROUP = "3"
"""MuJoCo's viewer does not show it at first: shapes that touch, where others are drawn."""


@dataclass(frozen=True, slots=True)
class _Part:
    """A geom: its type, its size [m], and its pose in the frame of its shape; or a hull."""

    kind: str
    size: tuple[float, ...] = ()
    pose: Pose = field(default_factory=Pose)
    hull: Hull | None = None


def add_geoms(body: ET.Element, assets: ET.Element, link: Link, name: str) -> tuple[str, ...]:
    """Add the geoms of a link to a body called `name`; return the names of those that can touch.

    A rounded box becomes three boxes and twelve capsules, which have exactly its surface. Meshes go
    to `assets`. Shapes that are drawn larger or smaller than they touch have two geoms.
    """
    names = []
    for number, shape in enumerate(link.shapes):
        own = f"{name}.shape_{number}"
        parts = _parts(shape.solid)
        for index, part in enumerate(parts):
            geom_name = own if len(parts) == 1 else f"{own}_{index}"
            element = _add_geom(body, assets, shape, part, geom_name)
            names.append(geom_name)
            if shape.visual_factor != 1:
                element.set("group", _HIDDEN_GROUP)
        if shape.visual_factor != 1:
            for index, part in enumerate(_parts(_resized(shape.solid, shape.visual_factor))):
                drawn = _add_geom(body, assets, shape, part, f"{own}_drawn_{index}")
                drawn.set("contype", "0")
                drawn.set("conaffinity", "0")
    return tuple(names)


def _add_geom(
    body: ET.Element, assets: ET.Element, shape: Shape, part: _Part, name: str
) -> ET.Element:
    pose = Pose.of(shape.position, shape.rpy).compose(part.pose)
    attributes = {"name": name, "type": part.kind}
    if part.hull is not None:
        _add_mesh(assets, part.hull, name)
        attributes["mesh"] = name
    else:
        attributes["size"] = numbers(part.size)
    attributes |= pose_attributes(pose.position, pose.rotation)
    attributes["rgba"] = numbers(shape.material.rgba)
    return ET.SubElement(body, "geom", attributes)


def _add_mesh(assets: ET.Element, hull: Hull, name: str) -> None:
    vertices = numbers(value for vertex in hull.vertices for value in vertex)
    faces = " ".join(str(index) for face in hull.faces for index in face)
    ET.SubElement(assets, "mesh", name=name, vertex=vertices, face=faces)


def _parts(solid: AnySolid) -> tuple[_Part, ...]:
    if isinstance(solid, Box):
        return (_Part("box", tuple(edge / 2 for edge in solid.size)),)
    if isinstance(solid, Cylinder):
        return (_Part("cylinder", (solid.radius, solid.length / 2)),)
    if isinstance(solid, Sphere):
        return (_Part("sphere", (solid.radius,)),)
    if isinstance(solid, Capsule):
        return (_Part("capsule", (solid.radius, solid.length / 2)),)
    if isinstance(solid, RoundedBox):
        return tuple(_rounded_parts(solid))
    return (_Part("mesh", hull=solid),)


def _rounded_parts(solid: RoundedBox) -> Iterator[_Part]:
    """Yield a slab for each pair of faces, and a capsule for each edge."""
    core, r = solid.core, solid.radius
    for axis in range(3):
        yield _Part(
            "box", tuple(half + (r if place == axis else 0.0) for place, half in enumerate(core))
        )
    for axis in range(3):
        for first, second in itertools.product((-1.0, 1.0), repeat=2):
            at = _edge_middle(core, axis, (first, second))
            yield _Part("capsule", (r, core[axis]), Pose(at, _Z_TO[axis]))


def _edge_middle(core: Sequence[float], axis: int, signs: tuple[float, float]) -> Vector:
    """Return the middle of the edge of the core that runs along an axis."""
    rest = iter(signs)
    return geometry.vector(0.0 if place == axis else next(rest) * core[place] for place in range(3))


_Z_TO = (
    geometry.rotation_about((0.0, 1.0, 0.0), math.pi / 2),
    geometry.rotation_about((1.0, 0.0, 0.0), -math.pi / 2),
    geometry.IDENTITY,
)
"""Rotations that take the z axis, that of a capsule, to x, y and z."""


def _resized(solid: AnySolid, factor: float) -> AnySolid:
    """Return a solid with all lengths times a factor; only those of links are drawn in a size."""
    if isinstance(solid, Box):
        x, y, z = (edge * factor for edge in solid.size)
        return Box((x, y, z))
    if isinstance(solid, Cylinder):
        return Cylinder(solid.length * factor, solid.radius * factor)
    assert isinstance(solid, Sphere), "objects are drawn as they are"
    return Sphere(solid.radius * factor)
