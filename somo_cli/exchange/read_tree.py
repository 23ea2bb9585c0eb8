"""Put links and joints that a reader found into a flat model; lump what fixed joints connect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from somo_cli.exchange.flat_model import FlatJoint, FlatLink, FlatModel, placed_link
from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import Inertial
from somo_cli.problems import Problem
from somo_cli.scene.urdf_values import report
from somo_cli.scene.urdf_xml import XmlElement

MAX_LINKS = 200
"""More than a definition can have."""


@dataclass(frozen=True, slots=True)
class ReadLink:
    """A link of a file: its pose with all joints at zero, and what it has in its own frame.

    `parent` is the number of its parent, -1 for a root. Without a `joint` it is fixed to it. The
    joint's parent is not used.
    """

    name: str
    element: XmlElement
    parent: int
    pose: Pose
    inertial: Inertial | None
    shapes: tuple[Shape, ...]
    joint: FlatJoint | None


def flat_model(problems: list[Problem], name: str, found: Sequence[ReadLink]) -> FlatModel | None:
    """Return the model of links, parents first; report a moving link without mass, or none at all.

    Links come depth first: a limb after another.
    """
    for link in found:
        _report_impossible(problems, link)
    if problems:
        return None
    numbers: list[int] = []  # of the lumped link that each link belongs to
    parts: list[list[ReadLink]] = []
    joints: list[FlatJoint] = []
    for link in found:
        if link.parent >= 0 and link.joint is None:
            parts[numbers[link.parent]].append(link)
            numbers.append(numbers[link.parent])
            continue
        if link.joint is not None:
            joints.append(replace(link.joint, parent=numbers[link.parent]))
        numbers.append(len(parts))
        parts.append([link])
    links = []
    for lump in parts:
        if not any(part.inertial and part.inertial.mass > 0 for part in lump):
            report(problems, lump[0].element, f"link '{lump[0].name}' has no mass")
        else:
            links.append(_lumped(lump))
    if problems:
        return None
    flat = FlatModel(name, tuple(links), tuple(joints))
    return flat.seen_from(links[0].pose)


def root_of_tree(
    problems: list[Problem],
    model: XmlElement,
    names: Sequence[str],
    joints: Sequence[tuple[str, str]],
) -> str | None:
    """Return the root of links that joints, pairs of parent and child, connect to one tree.

    If they do not, report why and return None.
    """
    children = [child for _, child in joints]
    roots = [name for name in names if name not in children]
    unknown = {one for joint in joints for one in joint} - set(names)
    faults = {
        "the parent or the child of a joint is no link": bool(unknown),
        f"there are {len(names)} links, more than {MAX_LINKS}": len(names) > MAX_LINKS,
        "two links have one name": len(set(names)) < len(names),
        "a link is the child of several joints": len(set(children)) < len(children),
        f"the links have {len(roots)} roots; a model has one": len(roots) != 1,
    }
    found = [message for message, is_true in faults.items() if is_true]
    if not found and len(_reached(roots[0], joints)) < len(names):
        found = ["some joints form a loop"]
    if found:
        report(problems, model, found[0])
        return None
    return roots[0]


def _reached(root: str, joints: Sequence[tuple[str, str]]) -> set[str]:
    reached, front = {root}, [root]
    while front:
        parent = front.pop()
        for one, child in joints:
            if one == parent and child not in reached:
                reached.add(child)
                front.append(child)
    return reached


def unit_axis(problems: list[Problem], element: XmlElement, values: Sequence[float]) -> Vector:
    """Return an axis as a unit vector; report one without a length."""
    axis = geometry.vector(values)
    if not 1e-9 < geometry.norm(axis) < 1e9:
        report(problems, element, "the axis of this joint has no length")
        return (1.0, 0.0, 0.0)
    return geometry.unit(axis)


def _report_impossible(problems: list[Problem], link: ReadLink) -> None:
    """Report a mass or a shape of no size, and springs that push."""
    if link.inertial is not None and (link.inertial.mass < 0 or min(_moments(link.inertial)) < 0):
        report(problems, link.element, f"the mass or an inertia of '{link.name}' is negative")
    if any(shape.solid.smallest_extent <= 0 for shape in link.shapes):
        report(problems, link.element, f"a shape of '{link.name}' has no size")
    if link.joint is not None:
        least = min(link.joint.stiffness, link.joint.damping, link.joint.friction)
        if least < 0:
            message = f"stiffness, damping or friction of '{link.joint.name}' is negative"
            report(problems, link.element, message)


def _moments(inertial: Inertial) -> tuple[float, float, float]:
    xx, _, _, yy, _, zz = inertial.inertia
    return xx, yy, zz


def _lumped(parts: Sequence[ReadLink]) -> FlatLink:
    """Return links that do not move relative to each other as one, with the frame of the first."""
    nothing = Inertial(0.0, (0.0, 0.0, 0.0), (0.0,) * 6)
    placed = [placed_link(one.name, one.pose, one.inertial or nothing, one.shapes) for one in parts]
    inertials = tuple(one.inertial for one in placed if one.inertial.mass > 0)
    shapes = tuple(shape for one in placed for shape in one.shapes)
    return FlatLink(placed[0].name, placed[0].pose, _sum(inertials), shapes)


def _sum(inertials: tuple[Inertial, ...]) -> Inertial:
    return inertials[0] if len(inertials) == 1 else solids.lumped(inertials)
