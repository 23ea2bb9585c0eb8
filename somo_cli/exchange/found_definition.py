"""Find the definition of a manipulator or an assembly that a flat model is."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.exchange.flat_model import FlatJoint, FlatLink, FlatModel, turned_shape
from somo_cli.exchange.found_actuators import found_actuators
from somo_cli.exchange.found_ends import EndPart, end_data, end_parts, homogeneous
from somo_cli.exchange.found_parts import SAME, Data, difference, dimensions, tidy
from somo_cli.exchange.precise_rpy import precise_rpy
from somo_cli.exchange.split_limb import NotADefinitionError, SplitLimb, split_limb
from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.solids import Inertial

_SAME_ANGLE = 1e-7  # rad


@dataclass(frozen=True, slots=True)
class _FoundLimb:
    """What is known of a limb: its frame, its parts, and its segment on the root in the frame."""

    name: str
    frame: Pose
    data: Data
    base: tuple[EndPart, ...]
    first: Inertial


def found_definition(flat: FlatModel) -> Data:
    """Return the definition of a model as data, without a world scale.

    Raises NotADefinitionError, with the first reason why no definition describes the model.
    """
    if not flat.joints:
        raise NotADefinitionError("it has no revolute joint")
    limbs = _limbs(flat)
    name = _safe_name(flat.name)
    root = flat.links[0]
    if len(limbs) == 1 and limbs[0][0].parent == 0:
        split = split_limb(root.shapes, flat.links[1:], flat.joints, flat.size)
        limb = _found_limb(name, Pose(), split, flat.links[1:], flat.joints, flat.size)
        data: Data = {"manipulator_name": name, **limb.data}
        if limb.base:
            (base,) = end_data(limb.base, root.inertial, [limb.first], 0.0, flat.size)
            data["base_definition"] = base
        elif abs(root.inertial.mass / limb.first.mass - 1) > SAME:
            raise NotADefinitionError("the root has more mass than its half segment, but no shape")
        return data
    return _assembly(flat, limbs, name)


def _limbs(flat: FlatModel) -> list[list[FlatJoint]]:
    """Return the joints of each limb. Raises NotADefinitionError where a limb branches."""
    limbs: list[list[FlatJoint]] = []
    for number, joint in enumerate(flat.joints):
        if joint.parent == 0:
            limbs.append([])
        elif joint.parent != number:
            raise NotADefinitionError(f"the chain branches at joint '{joint.name}'")
        limbs[-1].append(joint)
    return limbs


def _found_limb(
    name: str,
    frame: Pose,
    split: SplitLimb,
    links: Sequence[FlatLink],
    joints: Sequence[FlatJoint],
    size: float,
) -> _FoundLimb:
    """Return the parts of a limb but its base, whose mass is not known yet."""
    base = tuple(end_parts(split.base))
    if len(base) > 1:
        raise NotADefinitionError(f"{len(base)} shapes stand below the first segment")
    start = base[0].height if base else 0.0
    actuators = found_actuators(split, links, joints, start, size)
    height = actuators[-1].end
    data: Data = {"actuator_definitions": [one.data for one in actuators]}
    tips = end_parts(split.tips)
    if tips:
        found = end_data(tips, links[-1].inertial, [actuators[-1].last], height, size)
        data |= {"tip_definition": found[0]} if len(found) == 1 else {"tip_definitions": found}
    return _FoundLimb(name, frame, data, base, actuators[0].first)


def _assembly(flat: FlatModel, limbs: Sequence[Sequence[FlatJoint]], name: str) -> Data:
    root = flat.links[0]
    shapes = list(root.shapes)
    own = [shapes.pop(0)] if shapes else []
    found: list[_FoundLimb] = []
    first = 0
    for number, joints in enumerate(limbs):
        links = flat.links[1 + first : 1 + first + len(joints)]
        taken = _shapes_of_limb(shapes, links, joints, flat.size)
        while number == 0 and len(taken) > 3:  # the ends of the body
            own.append(taken.pop(0))
        found.append(_mounted_limb(_limb_name(joints[0].name, number), taken, links, joints, flat))
        first += len(joints)
    bodies = end_parts(own)
    if len(bodies) != 1:
        raise NotADefinitionError(f"the body has {len(bodies)} shapes")
    (body,) = bodies
    masses = _base_masses(root.inertial, body, found)
    bases = [
        homogeneous(_seen_outside(limb.base[0].shape, limb.frame), mass) if limb.base else None
        for limb, mass in zip(found, masses, strict=True)
    ]
    others = [_outside(limb.first, limb.frame) for limb in found]
    others += [one for one in bases if one is not None]
    (of_body,) = end_data([body], root.inertial, others, 0.0, flat.size)
    return {
        "assembly_name": name,
        "body_definition": of_body,
        "limbs": [
            _limb_data(limb, mass, flat.size) for limb, mass in zip(found, masses, strict=True)
        ],
    }


def _limb_data(limb: _FoundLimb, mass: float, size: float) -> Data:
    definition: Data = {"manipulator_name": "limb", **limb.data}
    if limb.base:
        whole = homogeneous(limb.base[0].shape, mass)
        (definition["base_definition"],) = end_data(limb.base, whole, [], 0.0, size)
    rpy = precise_rpy(limb.frame.rotation)
    return {
        "name": limb.name,
        "position": [tidy(one, size) for one in limb.frame.position],
        "rpy": [tidy(one, 1.0) for one in rpy],
        "definition": definition,
    }


def _shapes_of_limb(
    shapes: list[Shape], links: Sequence[FlatLink], joints: Sequence[FlatJoint], size: float
) -> list[Shape]:
    """Take the shapes of a limb from those of the root: up to its half segment and its filler."""
    segment = links[0].shapes[0]
    taken: list[Shape] = []
    while shapes:
        taken.append(shapes.pop(0))
        if _is_segment_below(taken[-1], segment):
            if shapes and _is_at(shapes[0], joints[0], size):
                taken.append(shapes.pop(0))
            return taken
    raise NotADefinitionError(f"no segment stands before joint '{joints[0].name}'")


def _is_at(shape: Shape, joint: FlatJoint, size: float) -> bool:
    return geometry.norm(geometry.subtract(shape.position, joint.hinge)) <= SAME * size


def _is_segment_below(shape: Shape, segment: Shape) -> bool:
    """Whether a shape has the cross-section and the axes of the segment above the first joint."""
    if type(shape.solid) is not type(segment.solid):
        return False
    one, other = (geometry.rotation_from_rpy(it.rpy) for it in (shape, segment))
    apart = geometry.rotation_vector(geometry.multiply(geometry.transposed(one), other))
    if geometry.norm(apart) > _SAME_ANGLE:
        return False
    widths, same = dimensions(shape.solid), dimensions(segment.solid)
    pairs = list(zip(widths, same, strict=True))
    across = pairs[:2] if len(pairs) == 3 else pairs[-1:]
    return all(abs(a - b) <= SAME * b for a, b in across)


def _mounted_limb(
    name: str,
    shapes: Sequence[Shape],
    links: Sequence[FlatLink],
    joints: Sequence[FlatJoint],
    flat: FlatModel,
) -> _FoundLimb:
    """Return a limb in its own frame: its first shape stands on the origin, z along the limb."""
    rotation = links[0].pose.rotation
    along = geometry.rotate(rotation, (0.0, 0.0, 1.0))
    below = geometry.scaled(along, shapes[0].solid.height / 2)
    frame = Pose(geometry.subtract(shapes[0].position, below), rotation)
    root = FlatLink("root", Pose(), flat.links[0].inertial, tuple(shapes))
    seen = FlatModel(name, (root, *links), tuple(joints)).seen_from(frame)
    split = split_limb(seen.links[0].shapes, seen.links[1:], seen.joints, flat.size)
    return _found_limb(name, frame, split, seen.links[1:], seen.joints, flat.size)


def _outside(inertial: Inertial, frame: Pose) -> Inertial:
    return solids.placed(inertial, frame.position, frame.rotation)


def _seen_outside(shape: Shape, frame: Pose) -> Shape:
    return turned_shape(shape, frame.point(shape.position), frame.rotation)


def _base_masses(root: Inertial, body: EndPart, limbs: Sequence[_FoundLimb]) -> list[float]:
    """Return the mass of the base of each limb, 0 without one; all bases weigh the same.

    Then the centre of mass of the root tells the mass of the body from those of the bases.
    """
    bases = [limb for limb in limbs if limb.base]
    if not bases:
        return [0.0] * len(limbs)
    halves = solids.lumped(tuple(_outside(limb.first, limb.frame) for limb in limbs))
    left = difference(root, halves)
    middle = [0.0, 0.0, 0.0]
    for limb in bases:
        at = limb.frame.point(limb.base[0].shape.position)
        middle = [a + b / len(bases) for a, b in zip(middle, at, strict=True)]
    between = geometry.subtract(geometry.vector(middle), body.shape.position)
    apart = geometry.subtract(left.centre, body.shape.position)
    share = geometry.dot(apart, between) / geometry.dot(between, between)
    if not 0 < share < 1:
        raise NotADefinitionError("the masses of body and bases cannot be told apart")
    return [share * left.mass / len(bases) if limb.base else 0.0 for limb in limbs]


def _limb_name(joint: str, number: int) -> str:
    found = re.fullmatch(r"(?:.*\.)?([A-Za-z][A-Za-z0-9_]*?)_actuator_\d+_joint_\d+", joint)
    return found[1] if found else f"limb_{number}"


def _safe_name(name: str) -> str:
    safe = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return safe if safe[:1].isalpha() else f"model_{safe}"
