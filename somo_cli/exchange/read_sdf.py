"""Read an SDF as a flat model: links, revolute joints and their springs."""

from __future__ import annotations

from somo_cli.exchange.flat_model import FlatJoint, FlatModel
from somo_cli.exchange.precise_rpy import precise_rpy
from somo_cli.exchange.read_tree import MAX_LINKS, ReadLink, flat_model, root_of_tree, unit_axis
from somo_cli.exchange.read_urdf import GREY, drawn_factor
from somo_cli.exchange.read_values import text_number, text_numbers, text_pose
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Inertial, Sphere
from somo_cli.problems import Problem
from somo_cli.scene.urdf_values import report
from somo_cli.scene.urdf_xml import XmlElement

_MAX_FRAMES = 2 * MAX_LINKS
_UNLIMITED = 1e15  # rad: SDF's word for a joint without limits is 1e16


def read_sdf(problems: list[Problem], root: XmlElement) -> FlatModel | None:
    """Return the only model of an SDF in its own units; report what is wrong with it."""
    models = [one for one in root.walk() if one.tag == "model"]
    if len(models) != 1:
        report(problems, root, f"there are {len(models)} models", "give a file with one")
        return None
    reader = _Reader(problems, models[0])
    found = reader.links()
    name = models[0].attributes.get("name", "model")
    return None if problems else flat_model(problems, name, found)


class _Reader:
    """Reads one model whose frames refer to each other by name."""

    def __init__(self, problems: list[Problem], model: XmlElement) -> None:
        self._problems = problems
        self._model = model
        named = ("link", "joint", "frame")
        self._frames = {
            one.attributes.get("name", ""): one for one in model.children if one.tag in named
        }
        self._joints = model.children_with_tag("joint")

    def links(self) -> list[ReadLink]:
        """Return all links below the root, parents first and depth first."""
        names = [one.attributes.get("name", "") for one in self._model.children_with_tag("link")]
        ends = [(self._end(one, "parent"), self._end(one, "child")) for one in self._joints]
        moved = [one for one in ends if one[0] not in ("world", "")]
        first = root_of_tree(self._problems, self._model, names, moved)
        if first is None:
            return []
        found: list[ReadLink] = []

        def add(name: str, parent: int, joint: XmlElement | None) -> None:
            number, element = len(found), self._frames[name]
            at = self._pose_of(name)
            found.append(
                ReadLink(
                    name,
                    element,
                    parent,
                    at,
                    self._inertial(element),
                    self._shapes(element),
                    None if joint is None else self._joint(joint),
                )
            )
            for one in self._joints:
                child = self._end(one, "child")
                if self._end(one, "parent") == name and child in self._frames:
                    add(child, number, one)

        add(first, -1, None)
        return found

    def _end(self, joint: XmlElement, tag: str) -> str:
        element = joint.first_child_with_tag(tag)
        return element.text if element else ""

    def _pose_of(self, name: str, depth: int = 0) -> Pose:
        """Return the pose of a link, joint or frame in the model's frame."""
        element = self._frames.get(name)
        if element is None or depth > _MAX_FRAMES:
            if name not in ("__model__", ""):
                report(self._problems, self._model, f"the frame '{name}' leads to nothing")
            return Pose()
        pose = element.first_child_with_tag("pose")
        default = {
            "joint": self._end(element, "child"),
            "frame": element.attributes.get("attached_to", ""),
        }.get(element.tag, "")
        frame = pose.attributes.get("relative_to", default) if pose else default
        return self._pose_of(frame, depth + 1).compose(text_pose(self._problems, element))

    def _inertial(self, link: XmlElement) -> Inertial | None:
        element = link.first_child_with_tag("inertial")
        inertia = element.first_child_with_tag("inertia") if element else None
        if element is None or inertia is None:
            return None
        at = text_pose(self._problems, element)
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        xx, xy, xz, yy, yz, zz = (text_number(self._problems, inertia, one, 0.0) for one in names)
        tensor = geometry.rotated_tensor((xx, xy, xz, yy, yz, zz), at.rotation)
        return Inertial(text_number(self._problems, element, "mass", 1.0), at.position, tensor)

    def _shapes(self, link: XmlElement) -> tuple[Shape, ...]:
        visuals = link.children_with_tag("visual")
        collisions = link.children_with_tag("collision") or visuals
        shapes = []
        for number, element in enumerate(collisions):
            solid, at = self._solid(element), text_pose(self._problems, element)
            factor, material = 1.0, GREY
            if len(visuals) == len(collisions) and solid.height > 0:
                factor = drawn_factor(solid, self._solid(visuals[number]))
                material = self._material(visuals[number])
            rpy = precise_rpy(at.rotation)
            shapes.append(Shape(solid, at.position, rpy, material, factor))
        return tuple(shapes)

    def _material(self, visual: XmlElement) -> Material:
        element = visual.first_child_with_tag("material")
        if element is None or element.first_child_with_tag("diffuse") is None:
            return GREY
        red, green, blue, opacity = text_numbers(self._problems, element, "diffuse", 4)
        return Material("", (red, green, blue, opacity))

    def _solid(self, owner: XmlElement) -> AnySolid:
        holder = owner.first_child_with_tag("geometry")
        shape = next(iter(holder.children), None) if holder else None
        if shape is not None and shape.tag == "box":
            return Box(geometry.vector(text_numbers(self._problems, shape, "size", 3)))
        if shape is not None and shape.tag in ("sphere", "cylinder"):
            (radius,) = text_numbers(self._problems, shape, "radius", 1)
            if shape.tag == "sphere":
                return Sphere(radius)
            return Cylinder(text_numbers(self._problems, shape, "length", 1)[0], radius)
        message, hint = "a shape that a definition has not", "box, cylinder or sphere"
        report(self._problems, owner, message, hint)
        return Sphere(1.0)

    def _joint(self, element: XmlElement) -> FlatJoint | None:
        problems, kind = self._problems, element.attributes.get("type", "")
        if kind == "fixed":
            return None
        axis = element.first_child_with_tag("axis")
        if kind not in ("revolute", "continuous") or axis is None:
            message = f"a joint of type '{kind}', or without <axis>"
            report(problems, element, message, "a definition has revolute ones")
            return None
        at = self._pose_of(element.attributes.get("name", ""))
        direction = unit_axis(problems, axis, text_numbers(problems, axis, "xyz", 3, "0 0 1"))
        limit, dynamics = (axis.first_child_with_tag(tag) for tag in ("limit", "dynamics"))
        lower = text_number(problems, limit, "lower", -_UNLIMITED)
        upper = text_number(problems, limit, "upper", _UNLIMITED)
        if kind == "continuous" or max(-lower, upper) >= _UNLIMITED:
            lower, upper = 0.0, -1.0
        return FlatJoint(
            name=element.attributes.get("name", ""),
            parent=0,
            hinge=at.position,
            axis=geometry.rotate(at.rotation, direction),
            lower=lower,
            upper=upper,
            effort=max(0.0, text_number(problems, limit, "effort", 0.0)),
            velocity=max(0.0, text_number(problems, limit, "velocity", 0.0)),
            stiffness=text_number(problems, dynamics, "spring_stiffness", 0.0),
            damping=text_number(problems, dynamics, "damping", 0.0),
            neutral_position=text_number(problems, dynamics, "spring_reference", 0.0),
            friction=text_number(problems, dynamics, "friction", 0.0),
        )
