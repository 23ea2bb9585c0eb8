"""Put links and joints that a reader found into a flat model; lump what fixed joints connect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from somo_cli.exchange.flat_model import FlatJoint, FlatLink, FlatModel, placed_link
from somo_cli.manipulator import solids
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import Inertial
from somo_cli.problems import Problem
from somo_cli.scene.urdf_values import report
from somo_cli.scene.urdf_xml import XmlElement


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
        if all(part.inertial is None for part in lump):
            report(problems, lump[0].element, f"link '{lump[0].name}' has no mass")
        else:
            links.append(_lumped(lump))
    if problems:
        return None
    flat = FlatModel(name, tuple(links), tuple(joints))
    return flat.seen_from(links[0].pose)


def _lumped(parts: Sequence[ReadLink]) -> FlatLink:
    """Return links that do not move relative to each other as one, with the frame of the first."""
    nothing = Inertial(0.0, (0.0, 0.0, 0.0), (0.0,) * 6)
    placed = [placed_link(one.name, one.pose, one.inertial or nothing, one.shapes) for one in parts]
    inertials = tuple(one.inertial for one in placed if one.inertial.mass > 0)
    shapes = tuple(shape for one in placed for shape in one.shapes)
    return FlatLink(placed[0].name, placed[0].pose, _sum(inertials), shapes)


def _sum(inertials: tuple[Inertial, ...]) -> Inertial:
    return inertials[0] if len(inertials) == 1 else solids.lumped(inertials)
