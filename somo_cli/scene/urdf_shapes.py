"""Read the shapes of a URDF: boxes, spheres, cylinders, capsules and meshes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from somo_cli.manipulator import geometry
from somo_cli.manipulator.round_solids import Capsule
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Inertial, Solid, Sphere
from somo_cli.problems import Problem, Span
from somo_cli.scene.mesh import Hulls, MeshFile, MeshProperties, mesh_properties
from somo_cli.scene.mesh_parts import MeshError
from somo_cli.scene.urdf_values import numbers, positive_numbers, report
from somo_cli.scene.urdf_xml import XmlElement

_SHAPE_TAGS = ("box", "sphere", "cylinder", "capsule", "mesh")


@dataclass(frozen=True, slots=True)
class ShapeSource:
    """The tag of the elements that hold shapes, the mesh files by name, and how to make hulls."""

    tag: str
    meshes: Mapping[str, MeshFile]
    hulls: Hulls | None


class UrdfMesh(NamedTuple):
    """A mesh that a URDF names: its place in the URDF, its name there, and its properties."""

    span: Span
    name: str
    properties: MeshProperties


class UrdfShape(NamedTuple):
    """The solids of one shape, and their mass properties at unit density, in the shape's frame.

    A shape with an error has no solids and no mass properties. `mesh` is None for other shapes.
    """

    solids: Sequence[AnySolid] = ()
    inertial: Inertial | None = None
    mesh: UrdfMesh | None = None


def read_shape(problems: list[Problem], owner: XmlElement, source: ShapeSource) -> UrdfShape:
    """Return the shape of a collision or visual element; add its errors to `problems`."""
    shape = owner.first_child_with_tag("geometry")
    element = next(iter(shape.children), None) if shape else None
    if element is None:
        report(problems, owner, f"this {owner.tag} has no geometry")
        return UrdfShape()
    if element.tag == "mesh":
        return _mesh_shape(problems, element, source)
    solid = _primitive(problems, element)
    if solid is None:
        return UrdfShape()
    volume = solid.volume
    return UrdfShape((solid,), Inertial(volume, geometry.ZERO, solid.inertia(volume)))


def _primitive(problems: list[Problem], element: XmlElement) -> Solid | Capsule | None:
    if element.tag == "box":
        return Box(geometry.vector(positive_numbers(problems, element, "size", 3)))
    if element.tag not in _SHAPE_TAGS:
        hint = f"the shapes are {', '.join(_SHAPE_TAGS)}"
        report(problems, element, f"unknown shape <{element.tag}>", hint)
        return None
    (radius,) = positive_numbers(problems, element, "radius")
    if element.tag == "sphere":
        return Sphere(radius)
    (length,) = positive_numbers(problems, element, "length")
    return Cylinder(length, radius) if element.tag == "cylinder" else Capsule(length, radius)


def _mesh_shape(problems: list[Problem], element: XmlElement, source: ShapeSource) -> UrdfShape:
    name = element.attributes.get("filename", "")
    scale = geometry.vector(numbers(problems, element, "scale", 3, "1 1 1"))
    if not name:
        report(problems, element, "<mesh> has no filename")
        return UrdfShape()
    if 0 in scale:
        message = f"scale of <mesh> is '{element.attributes['scale']}'"
        report(problems, element, message, "no factor may be 0")
        return UrdfShape()
    if name not in source.meshes:
        # only for a URDF given as text: for a file, reading the mesh has already failed
        hint = "give one file for each mesh in meshes"
        report(problems, element, f"mesh '{name}' is not given", hint)
        return UrdfShape()
    file = source.meshes[name]
    try:
        found = mesh_properties(file.text, file.source, scale, source.hulls, file.pieces)
    except MeshError as error:
        report(problems, element, f"mesh '{name}': {error}", error.hint)
        return UrdfShape()
    inertial = found.mesh_inertial or found.hull_inertial
    return UrdfShape(found.hulls, inertial, UrdfMesh(element.span, name, found))
