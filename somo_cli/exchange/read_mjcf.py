"""Read an MJCF as a flat model: one body tree of hinges with springs; the rest is left out."""

from __future__ import annotations

from somo_cli.exchange.flat_model import FlatJoint, FlatModel
from somo_cli.exchange.mjcf_values import MjcfValues
from somo_cli.exchange.precise_rpy import precise_rpy
from somo_cli.exchange.read_tree import ReadLink, flat_model, unit_axis
from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.definition import Material
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import Box, Cylinder, Inertial, Solid, Sphere
from somo_cli.problems import Problem
from somo_cli.scene.urdf_values import numbers, report
from somo_cli.scene.urdf_xml import XmlElement

_WATER = 1000.0  # kg/m³: MuJoCo's density of geoms
_MAKERS = {"frame", "replicate", "composite", "flexcomp", "include", "attach"}
_FREE = ("freejoint", "free")


def read_mjcf(problems: list[Problem], root: XmlElement, body: str | None) -> FlatModel | None:
    """Return the tree of a body of the world, the only one with hinges unless `body` names it."""
    bodies = _bodies(root, body)
    if len(bodies) != 1:
        names = ", ".join(one.attributes.get("name", "?") for one in bodies)
        what = "with hinges" if body is None else f"called '{body}'"
        message = f"the world has {len(bodies)} bodies {what}"
        report(problems, root, message, f"--body chooses one of {names}" if names else "")
        return None
    _report_unread(problems, root, bodies[0])
    reader = _Reader(MjcfValues(problems, root), _groups(root))
    reader.add(bodies[0], -1, Pose(), "")
    name = root.attributes.get("model", "model")
    return None if problems else flat_model(problems, name, reader.found)


def _report_unread(problems: list[Problem], root: XmlElement, body: XmlElement) -> None:
    """Report what makes bodies or masses that this reader would miss."""
    for element in (one for one in body.walk() if one.tag in _MAKERS):
        hint = "let MuJoCo write it out: mj_saveLastXML, or MjSpec.to_xml"
        report(problems, element, f"<{element.tag}> is not read", hint)
    for compiler in root.children_with_tag("compiler"):
        if compiler.attributes.get("inertiafromgeom", "auto") == "true":
            report(problems, compiler, "inertiafromgeom is not read", "give each body its inertia")


def _bodies(root: XmlElement, name: str | None) -> list[XmlElement]:
    """Return the bodies of the world that have a name, or those with hinges."""
    worlds = root.children_with_tag("worldbody")
    bodies = [one for world in worlds for one in world.children_with_tag("body")]
    if name is None:
        return [one for one in bodies if _has_hinge(one)]
    return [one for one in bodies if one.attributes.get("name") == name]


def _has_hinge(body: XmlElement) -> bool:
    return any(
        one.tag == "joint" and one.attributes.get("type", "hinge") == "hinge" for one in body.walk()
    )


def _groups(root: XmlElement) -> dict[str, int]:
    """Return the number of the tendon that holds each joint: one control drives them all."""
    tendons = [one for one in root.walk() if one.tag == "fixed"]
    return {
        joint.attributes.get("joint", ""): number
        for number, tendon in enumerate(tendons)
        for joint in tendon.children_with_tag("joint")
    }


class _Reader:
    """Collects the links of a body tree."""

    def __init__(self, values: MjcfValues, groups: dict[str, int]) -> None:
        self.found: list[ReadLink] = []
        self._values = values
        self._groups = groups

    def add(self, body: XmlElement, parent: int, at: Pose, child_class: str) -> None:
        """Add a body and all below it; `at` is the pose of its parent."""
        values, number = self._values, len(self.found)
        child_class = body.attributes.get("childclass", child_class)
        pose = at.compose(values.pose(body))
        joints = [values.full(one, child_class) for one in body.children_with_tag("joint")]
        hinges = [one for one in joints if one.attributes.get("type", "hinge") not in _FREE]
        if len(hinges) > 1:
            message = "a body with several joints"
            report(values.problems, body, message, "give each joint a body with a mass")
        geoms = [values.full(one, child_class) for one in body.children_with_tag("geom")]
        placed = [(one, *self._shape(one)) for one in geoms if not _is_drawn_only(one)]
        name = body.attributes.get("name", f"body_{number}")
        self.found.append(
            ReadLink(
                name,
                body,
                parent,
                pose,
                self._inertial(body) or _lumped(values, placed),
                tuple(shape for _, shape, _ in placed),
                self._joint(hinges[0], pose) if hinges and parent >= 0 else None,
            )
        )
        for child in body.children_with_tag("body"):
            self.add(child, number, pose, child_class)

    def _joint(self, element: XmlElement, body: Pose) -> FlatJoint:
        values = self._values
        if element.attributes.get("type", "hinge") != "hinge":
            report(values.problems, element, "a joint that is not a hinge")
        given = numbers(values.problems, element, "axis", 3, "0 0 1")
        axis = unit_axis(values.problems, element, given)
        place = geometry.vector(numbers(values.problems, element, "pos", 3, "0 0 0"))
        (lower, upper), start = values.range_of(element), values.angle(element, "ref")
        is_limited = lower <= upper
        name = element.attributes.get("name", f"joint_{len(self.found)}")
        if element.attributes.get("armature", "0") not in ("0", "0.0"):
            report(values.problems, element, "armature has no place in a definition")
        return FlatJoint(
            name=name,
            parent=0,
            hinge=body.point(place),
            axis=geometry.rotate(body.rotation, axis),
            lower=lower - start if is_limited else lower,
            upper=upper - start if is_limited else upper,
            stiffness=values.number(element, "stiffness"),
            damping=values.number(element, "damping"),
            neutral_position=values.angle(element, "springref") - start,
            friction=values.number(element, "frictionloss"),
            group=self._groups.get(name, -1),
        )

    def _inertial(self, body: XmlElement) -> Inertial | None:
        element = body.first_child_with_tag("inertial")
        if element is None:
            return None
        values, at = self._values, self._values.pose(element)
        if "fullinertia" in element.attributes:
            xx, yy, zz, xy, xz, yz = numbers(values.problems, element, "fullinertia", 6)
        else:
            (xx, yy, zz), xy, xz, yz = (
                numbers(values.problems, element, "diaginertia", 3),
                0.0,
                0.0,
                0.0,
            )
        tensor = geometry.rotated_tensor((xx, xy, xz, yy, yz, zz), at.rotation)
        return Inertial(values.number(element, "mass"), at.position, tensor)

    def _shape(self, geom: XmlElement) -> tuple[Shape, Solid]:
        values, at = self._values, self._values.pose(geom)
        red, green, blue, opacity = numbers(values.problems, geom, "rgba", 4, "0.5 0.5 0.5 1")
        material = Material("", (red, green, blue, opacity))
        solid = self._solid(geom)
        rpy = precise_rpy(at.rotation)
        return Shape(solid, at.position, rpy, material, 1.0), solid

    def _solid(self, geom: XmlElement) -> Solid:
        kind, problems = geom.attributes.get("type", "sphere"), self._values.problems
        counts = {"box": 3, "cylinder": 2, "sphere": 1}
        if kind not in counts:
            hint = "box, cylinder or sphere"
            report(problems, geom, f"a geom of type '{kind}', which a definition has not", hint)
            return Sphere(1.0)
        size = geom.attributes.get("size", "").split()
        text = " ".join(size[: counts[kind]])
        first, *others = numbers(problems, _with_size(geom, text), "size", counts[kind])
        if kind == "box":
            return Box((2 * first, 2 * others[0], 2 * others[1]))
        return Cylinder(2 * others[0], first) if kind == "cylinder" else Sphere(first)


def _with_size(geom: XmlElement, text: str) -> XmlElement:
    """Return a geom with the sizes that its type uses: others may stand there."""
    return XmlElement(geom.tag, {**geom.attributes, "size": text}, geom.span)


def _is_drawn_only(geom: XmlElement) -> bool:
    """Whether the name says that it is the drawing of a shape, as in a model of ours."""
    return "_drawn_" in geom.attributes.get("name", "")


def _lumped(values: MjcfValues, placed: list[tuple[XmlElement, Shape, Solid]]) -> Inertial | None:
    """Return the mass properties of geoms, by their mass or their density."""
    parts = []
    for geom, shape, solid in placed:
        density = values.number(geom, "density", _WATER)
        mass = values.number(geom, "mass", density * solid.volume)
        rotation = geometry.rotation_from_rpy(shape.rpy)
        own = Inertial(mass, geometry.ZERO, solid.inertia(mass))
        parts.append(solids.placed(own, shape.position, rotation))
    return solids.lumped(tuple(parts)) if parts else None
