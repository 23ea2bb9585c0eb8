"""Read a URDF whose links fixed joints connect as one rigid body: its shapes and inertias."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import AnySolid, Inertial, lumped, placed
from somo_cli.problems import InvalidFile, Problem, Span
from somo_cli.scene import urdf_xml
from somo_cli.scene.mesh import Hulls, MeshFile
from somo_cli.scene.urdf_joints import elements_by_name, link_poses
from somo_cli.scene.urdf_shapes import ShapeSource, UrdfMesh, read_shape
from somo_cli.scene.urdf_values import numbers, origin_of, report
from somo_cli.scene.urdf_xml import XmlElement

_INERTIA_ATTRIBUTES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True, slots=True)
class PlacedSolid:
    """A solid at this position [m] and rpy [rad] in the frame of the root link."""

    solid: AnySolid
    position: Vector
    rpy: Vector


@dataclass(frozen=True, slots=True)
class UrdfLink:
    """Mass properties of one link in the frame of the root link.

    `declared` is what the file gives, None if it gives no mass. `filled` is that of the link's
    shapes at unit density, None without shapes; overlapping shapes both count. `span` is the place
    of the inertia in the file, or of the link if the link has none.
    """

    name: str
    span: Span
    declared: Inertial | None
    filled: Inertial | None


@dataclass(slots=True)
class UrdfRigidBody:
    """One rigid body that a URDF describes, in the frame of its root link, and the errors in it.

    `solids` are the collision shapes or, if the file has none, the visual shapes; `is_drawn_only`
    is then True. `meshes` are the meshes among them. `links_without_inertia` has name and place of
    each link with a shape but without inertia.
    """

    span: Span
    solids: list[PlacedSolid] = field(default_factory=list)
    links: list[UrdfLink] = field(default_factory=list)
    meshes: list[UrdfMesh] = field(default_factory=list)
    is_drawn_only: bool = False
    links_without_inertia: list[tuple[str, Span]] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    @property
    def inertials(self) -> list[Inertial]:
        """The mass properties that the file gives, one for each link with a mass."""
        return [one.declared for one in self.links if one.declared is not None]


def read_rigid_body(
    text: str,
    source: str,
    meshes: Mapping[str, MeshFile],
    hulls: Hulls | None = None,
) -> UrdfRigidBody:
    """Return the body that the URDF `text` describes; its `problems` are the errors in the URDF.

    `meshes` has the mesh files by their names in the URDF; `hulls` is that of `mesh_properties`.
    """
    body = UrdfRigidBody(Span(source, 1, 1))
    try:
        root = urdf_xml.parse_xml(text, source)
    except InvalidFile as error:
        body.problems.extend(error.problems)
        return body
    body.span = root.span
    if root.tag != "robot":
        report(body.problems, root, f"a URDF starts with <robot>, not with <{root.tag}>")
        return body
    links = elements_by_name(body.problems, root, "link")
    poses = link_poses(body.problems, root, links)
    shape_tag = urdf_xml.shape_tag(root)
    body.is_drawn_only = shape_tag == "visual"
    for name, pose in poses.items():
        _add_link(body, links[name], pose, ShapeSource(shape_tag, meshes, hulls))
    if not body.problems and not body.solids:
        message = "the URDF has no collision shape, so that nothing could touch the object"
        report(body.problems, root, message, "give a link a <collision>")
    return body


def _add_link(body: UrdfRigidBody, link: XmlElement, pose: Pose, source: ShapeSource) -> None:
    inertial = link.first_child_with_tag("inertial")
    elements = link.children_with_tag(source.tag)
    if inertial is None and elements:
        body.links_without_inertia.append((link.attributes["name"], link.span))
    fillings: list[Inertial] = []
    for element in elements:
        place = pose.compose(origin_of(body.problems, element))
        rpy = geometry.rpy_from_rotation(place.rotation)
        shape = read_shape(body.problems, element, source)
        body.solids += [PlacedSolid(solid, place.position, rpy) for solid in shape.solids]
        if shape.mesh is not None:
            body.meshes.append(shape.mesh)
        if shape.inertial is not None:
            fillings.append(placed(shape.inertial, place.position, place.rotation))
    declared, span = None, link.span
    if inertial is not None:
        declared, span = _declared_inertial(body.problems, inertial, pose)
    filled = lumped(tuple(fillings)) if fillings else None
    body.links.append(UrdfLink(link.attributes["name"], span, declared, filled))


def _declared_inertial(
    problems: list[Problem], element: XmlElement, pose: Pose
) -> tuple[Inertial | None, Span]:
    """Return mass properties in the root link's frame, None without a mass, and their place."""
    mass, inertia = element.first_child_with_tag("mass"), element.first_child_with_tag("inertia")
    if mass is None or inertia is None:
        report(problems, element, f"<inertial> has no <{'mass' if mass is None else 'inertia'}>")
        return None, element.span
    (value,) = numbers(problems, mass, "value", 1)
    if value < 0:
        report(problems, mass, f"the mass is {value:g} kg, less than 0")
    xx, xy, xz, yy, yz, zz = (
        numbers(problems, inertia, name, 1, _default_inertia(name))[0]
        for name in _INERTIA_ATTRIBUTES
    )
    if not value > 0:
        return None, inertia.span
    place = pose.compose(origin_of(problems, element))
    own = Inertial(value, geometry.ZERO, (xx, xy, xz, yy, yz, zz))
    return placed(own, place.position, place.rotation), inertia.span


def _default_inertia(name: str) -> str | None:
    """Return the default of a product of inertia, None for a moment, which must be given."""
    return None if name in ("ixx", "iyy", "izz") else "0"
