"""The links of a URDF file, joined by fixed joints, as one rigid body: its shapes and inertias."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.round_solids import Capsule
from somo_cli.manipulator.solids import (
    AnySolid,
    Box,
    Cylinder,
    Inertial,
    Solid,
    Sphere,
    lumped,
    placed,
)
from somo_cli.problems import MAX_NUMBER, InvalidFile, Problem, Span
from somo_cli.scene import mesh, urdf_xml
from somo_cli.scene.mesh import Hulls, MeshFile, MeshProperties
from somo_cli.scene.urdf_xml import XmlElement

_SHAPES = ("box", "sphere", "cylinder", "capsule", "mesh")
_INERTIA_ATTRIBUTES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True, slots=True)
class PlacedSolid:
    """A collision shape in the frame of the root link."""

    solid: AnySolid
    position: Vector
    rpy: Vector


@dataclass(frozen=True, slots=True)
class UrdfLink:
    """Mass and inertia of one link in the frame of the root link.

    `declared` is from the file, None without a mass there. `filled` is that of the shapes at unit
    density, None without shapes; where shapes overlap, it counts the volume of each. `span` is the
    place of the inertia in the file, or of the link if there is none.
    """

    name: str
    span: Span
    declared: Inertial | None
    filled: Inertial | None


@dataclass(slots=True)
class UrdfRigidBody:
    """One rigid body that a URDF describes, in the frame of its root link, and the errors in it.

    `solids` are the collision shapes, or the visual shapes if the file has no collision shape;
    `is_drawn_only` says so. `meshes` has the place, name and properties of each mesh among them.
    `links_without_inertia` has the name and place of each link with a shape and no inertia.
    """

    span: Span
    solids: list[PlacedSolid] = field(default_factory=list)
    links: list[UrdfLink] = field(default_factory=list)
    meshes: list[tuple[Span, str, MeshProperties]] = field(default_factory=list)
    is_drawn_only: bool = False
    links_without_inertia: list[tuple[str, Span]] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    @property
    def inertials(self) -> list[Inertial]:
        """The mass and inertia that the file gives, of each link with a mass."""
        return [one.declared for one in self.links if one.declared is not None]


def read_rigid_body(
    text: str,
    source: str,
    meshes: Mapping[str, MeshFile],
    hulls: Hulls | None = None,
) -> UrdfRigidBody:
    """Return the body that the URDF `text` describes, with the errors in its `problems`.

    `meshes` has the mesh files by the names in the URDF; `hulls` is as in `mesh_properties`.
    """
    body = UrdfRigidBody(Span(source, 1, 1))
    try:
        root = urdf_xml.parse_xml(text, source)
    except InvalidFile as error:
        body.problems.extend(error.problems)
        return body
    body.span = root.span
    if root.tag != "robot":
        _report(body, root, f"a URDF starts with <robot>, not with <{root.tag}>")
        return body
    links = _elements_by_name(body, root, "link")
    poses = _poses(body, root, links)
    shape_tag = urdf_xml.shape_tag(root)
    body.is_drawn_only = shape_tag == "visual"
    for name, pose in poses.items():
        _add_link(body, links[name], pose, _Shapes(shape_tag, meshes, hulls))
    if not body.problems and not body.solids:
        _report(body, root, "there is no collision shape in it", "nothing could touch it")
    return body


def _report(body: UrdfRigidBody, element: XmlElement, message: str, hint: str = "") -> None:
    body.problems.append(Problem(element.span, message, hint))


def _elements_by_name(body: UrdfRigidBody, root: XmlElement, tag: str) -> dict[str, XmlElement]:
    found: dict[str, XmlElement] = {}
    for element in root.children_with_tag(tag):
        name = element.attributes.get("name")
        if name is None:
            _report(body, element, f"this {tag} has no name")
        elif name in found:
            _report(body, element, f"there is another {tag} '{name}'")
        else:
            found[name] = element
    return found


def _poses(
    body: UrdfRigidBody, root: XmlElement, links: Mapping[str, XmlElement]
) -> dict[str, Pose]:
    """Return the pose of every link in the frame of the root link, in the order of `links`.

    Reports the joints that do not make one tree of the links. Links that no fixed joint connects to
    the root link are left out; without a single root link there are no poses.
    """
    joints = _joints_by_child(body, root, links)
    root_link = _root_link(body, root, links, joints)
    if root_link is None:
        return {}
    poses = {root_link: Pose()}
    waiting = dict(joints)
    while waiting:
        ready = [child for child, joint in waiting.items() if joint.parent in poses]
        if not ready:
            in_circle = links[next(iter(waiting))]
            _report(body, in_circle, "this link hangs on itself", "join all to one link")
            break
        for child in ready:
            joint = waiting.pop(child)
            poses[child] = poses[joint.parent].compose(joint.pose)
    return {name: poses[name] for name in links if name in poses}


class _Joint(NamedTuple):
    """The parent link of a joint, and the pose of the child link in the frame of the parent."""

    parent: str
    pose: Pose


def _joints_by_child(
    body: UrdfRigidBody, root: XmlElement, links: Mapping[str, XmlElement]
) -> dict[str, _Joint]:
    """Return the joint above each child link; report joints that cannot be used."""
    joints: dict[str, _Joint] = {}
    for element in root.children_with_tag("joint"):
        name = element.attributes.get("name", "")
        _require_fixed(body, element, name)
        parent, child = _linked_name(element, "parent"), _linked_name(element, "child")
        unknown = [one for one in (parent, child) if one not in links]
        if unknown:
            known = f"links: {', '.join(links) or 'none'}"
            _report(body, element, f"joint '{name}' joins '{unknown[0]}', which is no link", known)
        elif child in joints:
            _report(body, element, f"link '{child}' has two parents")
        else:
            joints[child] = _Joint(parent, _origin(body, element))
    return joints


def _require_fixed(body: UrdfRigidBody, joint: XmlElement, name: str) -> None:
    kind = joint.attributes.get("type", "")
    if kind != "fixed":
        hint = "an object is one rigid body: make it fixed, or describe a manipulator"
        _report(body, joint, f"joint '{name}' is {kind or 'of no type'}, not fixed", hint)


def _linked_name(joint: XmlElement, end: str) -> str:
    """Return the name of the link at the `end` of a joint, parent or child; empty without one."""
    element = joint.first_child_with_tag(end)
    return element.attributes.get("link", "") if element else ""


def _root_link(
    body: UrdfRigidBody,
    root: XmlElement,
    links: Mapping[str, XmlElement],
    joints: Mapping[str, _Joint],
) -> str | None:
    """Return the one link without a parent; report and return None if there is not just one."""
    roots = [name for name in links if name not in joints]
    if len(roots) == 1:
        return roots[0]
    if body.problems:  # an earlier error may be the cause
        return None
    if roots:
        message = f"there are {len(roots)} links without a parent: {', '.join(roots)}"
    else:
        message = "every link has a parent" if links else "there is no link in it"
    _report(body, root, message, "join all to one link")
    return None


def _origin(body: UrdfRigidBody, element: XmlElement) -> Pose:
    origin = element.first_child_with_tag("origin")
    if origin is None:
        return Pose()
    position = _numbers(body, origin, "xyz", 3, "0 0 0")
    rpy = _numbers(body, origin, "rpy", 3, "0 0 0")
    return Pose.of(geometry.vector(position), geometry.vector(rpy))


def _numbers(
    body: UrdfRigidBody, element: XmlElement, name: str, count: int, default: str | None = None
) -> list[float]:
    """Return the numbers of an attribute; if they are wrong, report it and return ones."""
    text = element.attributes.get(name, default)
    words = "one number" if count == 1 else f"{count} numbers"
    if text is None:
        _report(body, element, f"<{element.tag}> has no {name}", f"it has {words}")
        return [1.0] * count
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(math.isfinite(value) for value in values):
        _report(body, element, f"{name} of <{element.tag}> is '{text}'", f"it has {words}")
        return [1.0] * count
    if max(map(abs, values)) > MAX_NUMBER:
        hint = f"no number may be larger than {MAX_NUMBER:g}"
        _report(body, element, f"{name} of <{element.tag}> is '{text}', too large", hint)
        return [1.0] * count
    return values


def _positive_numbers(
    body: UrdfRigidBody, element: XmlElement, name: str, count: int = 1
) -> list[float]:
    values = _numbers(body, element, name, count)
    if min(values) <= 0:
        text = element.attributes[name]
        _report(body, element, f"{name} of <{element.tag}> is '{text}', not greater than 0")
    return values


@dataclass(frozen=True, slots=True)
class _Shapes:
    """The tag of the elements that are shapes, the mesh files by name, and how to take hulls."""

    tag: str
    meshes: Mapping[str, MeshFile]
    hulls: Hulls | None


def _add_link(body: UrdfRigidBody, link: XmlElement, pose: Pose, shapes: _Shapes) -> None:
    inertial = link.first_child_with_tag("inertial")
    elements = link.children_with_tag(shapes.tag)
    if inertial is None and elements:
        body.links_without_inertia.append((link.attributes["name"], link.span))
    fillings: list[Inertial] = []
    for element in elements:
        place = pose.compose(_origin(body, element))
        rpy = geometry.rpy_from_rotation(place.rotation)
        found, filling = _solids(body, element, shapes)
        body.solids += [PlacedSolid(solid, place.position, rpy) for solid in found]
        if filling is not None:
            fillings.append(placed(filling, place.position, place.rotation))
    declared, span = None, link.span
    if inertial is not None:
        declared, span = _declared_inertial(body, inertial, pose)
    filled = lumped(tuple(fillings)) if fillings else None
    body.links.append(UrdfLink(link.attributes["name"], span, declared, filled))


def _declared_inertial(
    body: UrdfRigidBody, element: XmlElement, pose: Pose
) -> tuple[Inertial | None, Span]:
    mass, inertia = element.first_child_with_tag("mass"), element.first_child_with_tag("inertia")
    if mass is None or inertia is None:
        _report(body, element, f"<inertial> has no <{'mass' if mass is None else 'inertia'}>")
        return None, element.span
    (value,) = _numbers(body, mass, "value", 1)
    if value < 0:
        _report(body, mass, f"the mass is {value:g} kg, less than 0")
    xx, xy, xz, yy, yz, zz = (
        _numbers(body, inertia, name, 1, _default_inertia(name))[0] for name in _INERTIA_ATTRIBUTES
    )
    if not value > 0:
        return None, inertia.span
    place = pose.compose(_origin(body, element))
    own = Inertial(value, geometry.ZERO, (xx, xy, xz, yy, yz, zz))
    return placed(own, place.position, place.rotation), inertia.span


def _default_inertia(name: str) -> str | None:
    """Return the default of a moment or product of inertia, None for those that must be given."""
    return None if name in ("ixx", "iyy", "izz") else "0"


def _solids(
    body: UrdfRigidBody, owner: XmlElement, shapes: _Shapes
) -> tuple[Sequence[AnySolid], Inertial | None]:
    """Return the solids of a collision or visual element, and their inertia at unit density."""
    shape = owner.first_child_with_tag("geometry")
    element = next(iter(shape.children), None) if shape else None
    if element is None:
        _report(body, owner, f"this {owner.tag} has no geometry")
        return (), None
    if element.tag == "mesh":
        found = _mesh(body, element, shapes)
        return (found.hulls, found.mesh_inertial or found.hull_inertial) if found else ((), None)
    solid = _primitive(body, element)
    if solid is None:
        return (), None
    volume = solid.volume
    return (solid,), Inertial(volume, geometry.ZERO, solid.inertia(volume))


def _primitive(body: UrdfRigidBody, element: XmlElement) -> Solid | Capsule | None:
    if element.tag == "box":
        return Box(geometry.vector(_positive_numbers(body, element, "size", 3)))
    if element.tag not in _SHAPES:
        _report(body, element, f"unknown shape <{element.tag}>", f"shapes: {', '.join(_SHAPES)}")
        return None
    (radius,) = _positive_numbers(body, element, "radius")
    if element.tag == "sphere":
        return Sphere(radius)
    (length,) = _positive_numbers(body, element, "length")
    return Cylinder(length, radius) if element.tag == "cylinder" else Capsule(length, radius)


def _mesh(body: UrdfRigidBody, element: XmlElement, shapes: _Shapes) -> MeshProperties | None:
    name = element.attributes.get("filename", "")
    scale = geometry.vector(_numbers(body, element, "scale", 3, "1 1 1"))
    if not name:
        _report(body, element, "<mesh> has no filename")
        return None
    if 0 in scale:
        _report(body, element, f"scale of <mesh> is '{element.attributes['scale']}'", "none is 0")
        return None
    if name not in shapes.meshes:
        # only for a URDF given as text: for a file, reading the mesh has already failed
        _report(body, element, f"mesh '{name}' is not given", "meshes has one file for each name")
        return None
    file = shapes.meshes[name]
    try:
        found = mesh.mesh_properties(file.text, file.source, scale, shapes.hulls, file.pieces)
    except mesh.MeshError as error:
        _report(body, element, f"mesh '{name}': {error}", error.hint)
        return None
    body.meshes.append((element.span, name, found))
    return found
