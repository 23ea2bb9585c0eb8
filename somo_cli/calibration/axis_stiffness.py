"""The joint stiffness that a definition gives to an axis."""

from __future__ import annotations

from somo_cli.manipulator.definition import Definition


def axis_stiffness(definition: Definition, actuator: int, axis: int) -> list[float]:
    """Return the stiffness of the joint definitions of an axis [N·m/rad]; one if all are equal."""
    one = definition.actuators[actuator]
    found = [
        joint.stiffness
        for channel, joint in zip(one.channels, one.joints, strict=True)
        if channel == axis and joint.joint_type != "fixed"
    ]
    return found if len(set(found)) > 1 else found[:1]


def first_joint_stiffness(definition: Definition | None, actuator: int, axis: int) -> float | None:
    """Return the stiffness of the first moving joint of an axis [N·m/rad]; None if it has none."""
    if definition is None:
        return None
    one = definition.actuators[actuator]
    moving = (
        joint.stiffness
        for channel, joint in zip(one.channels, one.joints, strict=True)
        if channel == axis and joint.joint_type != "fixed"
    )
    return next(moving) or None
