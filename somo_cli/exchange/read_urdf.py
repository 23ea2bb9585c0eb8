"""Read a URDF as a flat model: links, revolute joints, dynamics, and springs of Gazebo's tags."""

from __future__ import annotations

import re
from collections.abc import Mapping

from somo_cli.exchange.flat_model import FlatJoint, FlatModel
from somo_cli.exchange.precise_rpy import precise_rpy
from somo_cli.exchange.read_tree import ReadLink, flat_model, root_of_tree, unit_axis
from somo_cli.exchange.read_values import text_number
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.dimensions import Scale
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Inertial, Sphere
from somo_cli.problems import Problem
from somo_cli.scene.urdf_values import numbers, origin_of, positive_numbers, report
from somo_cli.scene.urdf_xml import XmlElement

GREY = Material("grey", (0.6, 0.6, 0.6, 1.0))
_SCALE = re.compile(
    r"<!-- World scale \S+, for PyBullet: lengths are (\S+) times and masses (\S+) "
)


def scale_in(text: str) -> Scale:
    """Return the world scale that the first comment of a URDF of ours gives, else 1."""
    found = _SCALE.search(text[:1000])
    return Scale(float(found[1]), float(found[2])) if found else Scale()


def read_urdf(problems: list[Problem], root: XmlElement) -> FlatModel | None:
    """Return the model of a URDF in its own units; report what is wrong with it."""
    links = {one.attributes.get("name", ""): one for one in root.children_with_tag("link")}
    springs = {
        one.attributes.get("reference", ""): one
        for one in root.children_with_tag("gazebo")
        if one.first_child_with_tag("springStiffness") is not None
    }
    joints_from: dict[str, list[XmlElement]] = {}
    for joint in root.children_with_tag("joint"):
        joints_from.setdefault(_end(joint, "parent"), []).append(joint)
    names = [one.attributes.get("name", "") for one in root.children_with_tag("link")]
    ends = [(_end(one, "parent"), _end(one, "child")) for one in root.children_with_tag("joint")]
    first = root_of_tree(problems, root, names, ends)
    if first is None:
        return None
    materials = _materials(problems, root)
    found: list[ReadLink] = []

    def add(name: str, parent: int, pose: Pose, joint: FlatJoint | None) -> None:
        element, number = links[name], len(found)
        inertial, shapes = _inertial(problems, element), _shapes(problems, element, materials)
        found.append(ReadLink(name, element, parent, pose, inertial, shapes, joint))
        for one in joints_from.get(name, ()):
            at = pose.compose(origin_of(problems, one))
            spring = springs.get(one.attributes.get("name", ""))
            add(_end(one, "child"), number, at, _joint(problems, one, spring, at))

    add(first, -1, Pose(), None)
    return None if problems else flat_model(problems, root.attributes.get("name", "model"), found)


def _end(joint: XmlElement, tag: str) -> str:
    element = joint.first_child_with_tag(tag)
    return element.attributes.get("link", "") if element else ""


def _joint(
    problems: list[Problem], element: XmlElement, spring: XmlElement | None, at: Pose
) -> FlatJoint | None:
    kind = element.attributes.get("type", "")
    if kind == "fixed":
        return None
    if kind not in ("revolute", "continuous"):
        report(problems, element, f"a joint of type '{kind}'", "a definition has revolute ones")
    axis = element.first_child_with_tag("axis")
    given = numbers(problems, axis, "xyz", 3) if axis else (1.0, 0.0, 0.0)
    direction = unit_axis(problems, element, given)
    limit, dynamics = (element.first_child_with_tag(tag) for tag in ("limit", "dynamics"))

    def value(owner: XmlElement | None, name: str, default: float = 0.0) -> float:
        return numbers(problems, owner, name, 1, repr(default))[0] if owner else default

    is_limited = kind == "revolute"
    return FlatJoint(
        name=element.attributes.get("name", ""),
        parent=0,
        hinge=at.position,
        axis=geometry.rotate(at.rotation, direction),
        lower=value(limit, "lower") if is_limited else 0.0,
        upper=value(limit, "upper") if is_limited else -1.0,
        effort=value(limit, "effort"),
        velocity=value(limit, "velocity"),
        stiffness=text_number(problems, spring, "springStiffness", 0.0),
        damping=value(dynamics, "damping"),
        neutral_position=text_number(problems, spring, "springReference", 0.0),
        friction=value(dynamics, "friction"),
    )


def _inertial(problems: list[Problem], link: XmlElement) -> Inertial | None:
    element = link.first_child_with_tag("inertial")
    mass = element.first_child_with_tag("mass") if element else None
    inertia = element.first_child_with_tag("inertia") if element else None
    if element is None or mass is None or inertia is None:
        return None
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    xx, xy, xz, yy, yz, zz = (numbers(problems, inertia, one, 1, "0")[0] for one in names)
    at = origin_of(problems, element)
    tensor = geometry.rotated_tensor((xx, xy, xz, yy, yz, zz), at.rotation)
    return Inertial(positive_numbers(problems, mass, "value")[0], at.position, tensor)


def _shapes(
    problems: list[Problem], link: XmlElement, materials: Mapping[str, Material]
) -> tuple[Shape, ...]:
    """Return the collision shapes, each with the colour and the size of its visual shape."""
    visuals = link.children_with_tag("visual")
    collisions = link.children_with_tag("collision") or visuals
    is_paired = len(visuals) == len(collisions)
    shapes = []
    for number, element in enumerate(collisions):
        at, solid = origin_of(problems, element), _solid(problems, element)
        factor, material = 1.0, GREY
        if is_paired and solid.height > 0:
            factor = drawn_factor(solid, _solid(problems, visuals[number]))
            name = visuals[number].first_child_with_tag("material")
            material = materials.get(name.attributes.get("name", ""), GREY) if name else GREY
        rpy = precise_rpy(at.rotation)
        shapes.append(Shape(solid, at.position, rpy, material, factor))
    return tuple(shapes)


def drawn_factor(solid: AnySolid, drawn: AnySolid) -> float:
    """Return the size of what is drawn relative to a solid, 1 for another shape."""
    if type(solid) is not type(drawn) or not isinstance(solid, Box | Cylinder | Sphere):
        return 1.0
    factor = drawn.height / solid.height
    return factor if abs(factor - 1) > 1e-12 else 1.0


def _solid(problems: list[Problem], element: XmlElement) -> AnySolid:
    holder = element.first_child_with_tag("geometry")
    shape = next(iter(holder.children), None) if holder else None
    if shape is not None and shape.tag == "box":
        return Box(geometry.vector(positive_numbers(problems, shape, "size", 3)))
    if shape is not None and shape.tag in ("sphere", "cylinder"):
        (radius,) = positive_numbers(problems, shape, "radius")
        if shape.tag == "sphere":
            return Sphere(radius)
        return Cylinder(positive_numbers(problems, shape, "length")[0], radius)
    report(problems, element, "a shape that a definition has not", "box, cylinder or sphere")
    return Sphere(1.0)


def _materials(problems: list[Problem], root: XmlElement) -> dict[str, Material]:
    """Return the materials of the robot by name."""
    found = {}
    for element in root.children_with_tag("material"):
        name, colour = element.attributes.get("name", ""), element.first_child_with_tag("color")
        if colour is not None:
            red, green, blue, opacity = numbers(problems, colour, "rgba", 4)
            found[name] = Material(name, (red, green, blue, opacity))
    return found
