"""Divide a manipulator into another number of segments of the same continuous backbone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from somo_cli.manipulator import assembly_chain
from somo_cli.manipulator.compile import Compiled
from somo_cli.manipulator.definition import ActuatorDefinition, JointDefinition, LinkDefinition
from somo_cli.manipulator.joint_placement import actuator_of, scaled_to_share
from somo_cli.manipulator.solids import Box, Cylinder


class NotUniform(ValueError):
    """The joints or links of an actuator vary along it, so that its segments cannot be changed."""


def cut(compiled: Compiled, count: int) -> Compiled:
    """Return the manipulator with `count` segments in every actuator.

    Length, mass and flexural rigidity do not change. With more segments, links are shorter and
    lighter, joints are stiffer and more damped, and their angles (limits, neutral position) are
    smaller, so that the limits of curvature do not change. Torques (dry friction, effort) are
    moments in the backbone and do not change. Links get the inertia of a homogeneous solid, even if
    another one was declared.

    Raises NotUniform if joints of one axis differ, if links are spheres, and if there are fewer
    segments than axes.
    """
    definition = replace(
        compiled.definition,
        actuators=tuple(
            _cut_actuator(actuator, index, count)
            for index, actuator in enumerate(compiled.definition.actuators)
        ),
    )
    return replace(compiled, definition=definition, chain=assembly_chain.build(definition))


def per_joint(values: Sequence[float], before: Compiled, after: Compiled) -> tuple[float, ...]:
    """Return joint angles or rates of `before`, one per joint, for the joints of `after`.

    The curvature of each axis of an actuator does not change. Raises NotUniform if it is not
    uniform.
    """
    curvatures: dict[tuple[int, int], float] = {}
    for joint, value in zip(before.chain.joints, values, strict=True):
        channel = joint.actuator, joint.channel
        if curvatures.setdefault(channel, value / joint.span) != value / joint.span:
            raise NotUniform(f"they differ along axis {joint.channel} of actuator {joint.actuator}")
    return tuple(
        curvatures[joint.actuator, joint.channel] * joint.span for joint in after.chain.joints
    )


def _cut_actuator(actuator: ActuatorDefinition, index: int, count: int) -> ActuatorDefinition:
    axes = max(actuator.channels) + 1
    by_channel: dict[int, JointDefinition] = {}
    for channel, joint in zip(actuator.channels, actuator.joints, strict=True):
        if by_channel.setdefault(channel, joint) != joint:
            raise NotUniform(f"the joints of actuator {index} differ along it")
    if count < axes:
        raise NotUniform(f"actuator {index} has {axes} axes, which need as many segments")
    share = actuator.n_segments / count
    joints = {channel: scaled_to_share(joint, share) for channel, joint in by_channel.items()}
    turns = tuple(number % axes for number in range(count))
    return actuator_of(
        _cut_link(actuator.link, share, index),
        actuator.placement,
        tuple(joints[turn] for turn in turns),
        turns,
        axes,
        actuator.taper,
    )


def _cut_link(link: LinkDefinition, share: float, index: int) -> LinkDefinition:
    solid = link.solid
    if isinstance(solid, Box):
        x, y, z = solid.size
        shorter: Box | Cylinder = Box((x, y, z * share))
    elif isinstance(solid, Cylinder):
        shorter = Cylinder(solid.length * share, solid.radius)
    else:
        raise NotUniform(f"the links of actuator {index} are spheres, which have no length")
    return replace(link, solid=shorter, mass=link.mass * share, inertia=None)
