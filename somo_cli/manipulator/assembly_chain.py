"""Build the chain of a definition; that of an assembly has its limbs on one root, the body.

The part of a limb before its first joint is lumped into the body.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Chain, Joint, Limb, Link, Shape
from somo_cli.manipulator.chain_build import build_chain
from somo_cli.manipulator.definition import Definition, LimbDefinition


def build(definition: Definition) -> Chain:
    """Return the chain of a definition without errors, in the unit of the definition."""
    if not definition.limbs:
        return build_chain(definition)
    body = build_chain(replace(definition, actuators=(), limbs=())).links[0]
    alone = tuple(_chains_alone(definition))
    pairs = tuple(zip(definition.limbs, alone, strict=True))
    joints: list[Joint] = []
    limbs: list[Limb] = []
    first_actuator = 0
    for limb, one in pairs:
        first = len(joints)
        joints.extend(_mounted(joint, limb, first, first_actuator) for joint in one.joints)
        limbs.append(Limb(limb.name, first, len(joints), first_actuator, one.tip))
        first_actuator += limb.n_actuators
    links = tuple(
        replace(link, name=f"{limb.name}_{link.name}")
        for limb, one in pairs
        for link in one.links[1:]
    )
    return Chain(
        name=definition.name,
        links=(_with_roots(body, pairs), *links),
        joints=tuple(joints),
        tip=limbs[-1].tip,
        length=max(one.length for one in alone),
        limbs=tuple(limbs),
    )


def _chains_alone(definition: Definition) -> Iterator[Chain]:
    """Yield the chain of each limb as a separate manipulator."""
    first = 0
    for limb in definition.limbs:
        actuators = definition.actuators[first : first + limb.n_actuators]
        yield build_chain(Definition(limb.name, None, limb.base, actuators, limb.tips))
        first += limb.n_actuators


def _with_roots(body: Link, limbs: tuple[tuple[LimbDefinition, Chain], ...]) -> Link:
    """Return the body with the root link of each limb lumped into it where the limb is mounted."""
    inertials, shapes = [body.inertial], [*body.shapes]
    for limb, one in limbs:
        root, rotation = one.links[0], geometry.rotation_from_rpy(limb.rpy)
        inertials.append(solids.placed(root.inertial, limb.position, rotation))
        shapes.extend(_moved(shape, limb) for shape in root.shapes)
    return replace(body, inertial=solids.lumped(tuple(inertials)), shapes=tuple(shapes))


def _moved(shape: Shape, limb: LimbDefinition) -> Shape:
    """Return a shape in the frame of the body, from its pose in the base frame of a limb."""
    rotation = geometry.rotation_from_rpy(limb.rpy)
    turned = geometry.multiply(rotation, geometry.rotation_from_rpy(shape.rpy))
    return replace(
        shape,
        position=geometry.add(limb.position, geometry.rotate(rotation, shape.position)),
        rpy=geometry.rpy_from_rotation(turned),
    )


def _mounted(joint: Joint, limb: LimbDefinition, first: int, first_actuator: int) -> Joint:
    """Return a joint of a limb as one of the assembly, where `first` joints precede the limb."""
    joint = replace(
        joint, name=f"{limb.name}_{joint.name}", actuator=first_actuator + joint.actuator
    )
    if joint.parent > 0:
        return replace(joint, parent=first + joint.parent)
    rotation = geometry.rotation_from_rpy(limb.rpy)
    origin = geometry.add(limb.position, geometry.rotate(rotation, joint.origin))
    return replace(joint, origin=origin, rpy=limb.rpy)
