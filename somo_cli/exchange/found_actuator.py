"""Find the definition of an actuator from its segments and joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from somo_cli.exchange.flat_model import FlatJoint, FlatLink
from somo_cli.exchange.found_parts import (
    SAME,
    Data,
    are_same,
    joint_data,
    kind_of,
    link_data,
    part_of,
    with_height,
)
from somo_cli.exchange.split_limb import NotADefinitionError, SplitActuator
from somo_cli.manipulator import geometry, joint_placement, solids
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.definition import Placement
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Inertial, Sphere


@dataclass(frozen=True, slots=True)
class FoundActuator:
    """An actuator as data, the mass properties of its first and last segment, and its end."""

    data: Data
    first: Inertial
    last: Inertial
    end: float


def found_actuator(
    split: SplitActuator,
    links: Sequence[FlatLink],
    joints: Sequence[FlatJoint],
    start: float,
    size: float,
    half: Inertial | None = None,
) -> FoundActuator:
    """Return the definition of an actuator that begins at height `start` of the backbone.

    `links` and `joints` are all of the limb, the root not among the links. `half` has the mass
    properties of one of both segments of an actuator of one joint, if they are known. Raises
    NotADefinitionError.
    """
    segments, own = split.segments, joints[split.first : split.last]
    count = len(own)
    heights = [one.solid.height for one in segments]
    full_height = sum(heights) / count
    fractions = [height / full_height for height in heights]
    turns = _turns(own)
    placement, shares = _placement(fractions, turns)
    full_solid = with_height(segments[0].solid, full_height)
    if count > 1:
        _require_middle(links[split.links[1] - 1], segments[1])
    full = _full_inertial(split, links, fractions, full_solid, half)
    starts = [start + sum(heights[:number]) for number in range(count + 1)]
    offset = _offset(segments[0], starts[0])
    for segment, at in zip(segments, starts, strict=True):
        is_alike = with_height(segment.solid, full_height) == full_solid or _are_close(
            with_height(segment.solid, full_height), full_solid
        )
        aside = geometry.norm(geometry.subtract(_offset(segment, at), offset))
        if not is_alike or aside > SAME * size:
            raise NotADefinitionError(
                f"the segments of the joints from '{own[0].name}' on are not of one shape in line"
            )
    hinges = starts[1:]
    found = [
        joint_data(
            _evenly_placed(one, share),
            geometry.subtract(one.hinge, (0.0, 0.0, hinge)),
            size,
        )
        for one, share, hinge in zip(own, shares, hinges, strict=True)
    ]
    shape = replace(segments[0], solid=full_solid)
    link = link_data(
        shape,
        kind_of(full_solid, split.is_rounded),
        solids.placed(full, shape.position, geometry.rotation_from_rpy(shape.rpy)),
        offset,
        size,
        0.0,
    )
    data: Data = {"n_segments": count}
    if placement != "uniform":
        data["joint_placement"] = placement
    data |= _joint_definitions(found, turns, own, size) | {"link_definition": link}
    first = part_of(segments[0], full, full_solid, fractions[0])
    last = part_of(segments[-1], full, full_solid, fractions[-1])
    return FoundActuator(data, first, last, start + sum(heights))


def _require_middle(link: FlatLink, shape: Shape) -> None:
    apart = geometry.norm(geometry.subtract(link.inertial.centre, shape.position))
    if apart > SAME * max(geometry.norm(shape.position), shape.solid.circumradius):
        raise NotADefinitionError(f"the centre of mass of link '{link.name}' is not in its middle")


def _offset(segment: Shape, start: float) -> Vector:
    middle = (0.0, 0.0, start + segment.solid.height / 2)
    return geometry.subtract(segment.position, middle)


def _are_close(one: AnySolid, other: AnySolid) -> bool:
    return isinstance(one, type(other)) and all(
        abs(one.reach(along) / other.reach(along) - 1) <= SAME
        for along in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )


def _turns(joints: Sequence[FlatJoint]) -> int:
    """Return after how many joints their axes repeat."""
    for period in range(1, len(joints) + 1):
        pairs = zip(joints, joints[period:], strict=False)
        if all(geometry.dot(one.axis, other.axis) > 1 - SAME for one, other in pairs):
            return period
    return len(joints)


def _placement(fractions: Sequence[float], turns: int) -> tuple[Placement, tuple[float, ...]]:
    """Return how the joints are placed, and the share of the backbone of each."""
    count = len(fractions) - 1
    axes = turns if turns <= 3 else 1
    placements: tuple[Placement, ...] = ("uniform", "gauss")
    for placement in placements:
        channels = [number % axes for number in range(count)]
        where = joint_placement.layout(placement, channels, axes)
        if all(abs(a - b) <= 1e-7 for a, b in zip(fractions, where.fractions, strict=True)):
            return placement, where.shares
    raise NotADefinitionError(
        "the joints are neither in the middle of equal segments nor at Gauss points"
    )


def _evenly_placed(joint: FlatJoint, share: float) -> FlatJoint:
    """Return the properties of a joint as if it were evenly placed."""
    limit = share if joint.is_limited else 1.0
    return replace(
        joint,
        lower=joint.lower / limit,
        upper=joint.upper / limit,
        velocity=joint.velocity / share,
        stiffness=joint.stiffness * share,
        damping=joint.damping * share,
        neutral_position=joint.neutral_position / share,
    )


def _joint_definitions(
    found: Sequence[Data], turns: int, joints: Sequence[FlatJoint], size: float
) -> Data:
    """Return the joint definitions that take turns, and the flag that says how."""
    is_repeated = all(
        are_same(one, other, size) for one, other in zip(found, found[turns:], strict=False)
    )
    if turns == 1 and is_repeated:
        return {"planar_flag": 1, "joint_definitions": [found[0]]}
    if turns in (2, 3) and is_repeated:
        return {"planar_flag": 0, "joint_definitions": list(found[:turns])}
    if turns == 1:
        return {"planar_flag": 2, "joint_definitions": list(found)}
    raise NotADefinitionError(
        f"the joints from '{joints[0].name}' on neither take turns about two or three axes nor "
        "have one axis"
    )


def _full_inertial(
    split: SplitActuator,
    links: Sequence[FlatLink],
    fractions: Sequence[float],
    full: AnySolid,
    half: Inertial | None,
) -> Inertial:
    """Return mass and inertia of a full link, in its own axes, from a link that is one segment.

    An actuator of one joint has no such link. If nothing else is known, its density is that of the
    link after it.
    """
    assert isinstance(full, Box | Cylinder | Sphere)
    if len(fractions) > 2:
        link = links[split.links[1] - 1]
        return _full_of(split.segments[1], link.inertial, fractions[1], full)
    if half is not None:
        return _full_of(split.segments[0], half, fractions[0], full)
    link = links[split.links[1] - 1]
    volume = sum(
        one.solid.volume for one in link.shapes if isinstance(one.solid, Box | Cylinder | Sphere)
    )
    mass = link.inertial.mass * full.volume / volume
    return Inertial(mass, geometry.ZERO, full.inertia(mass))


def _full_of(
    shape: Shape, inertial: Inertial, fraction: float, full: Box | Cylinder | Sphere
) -> Inertial:
    """Return mass and inertia of a full link from those of one of its segments."""
    turned = geometry.transposed(geometry.rotation_from_rpy(shape.rpy))
    tensor = geometry.rotated_tensor(inertial.inertia, turned)
    if fraction != 1:
        tensor = solids.shortened_inertia(full.shortened(fraction), tensor, 1 / fraction)
    return Inertial(inertial.mass / fraction, geometry.ZERO, tensor)
