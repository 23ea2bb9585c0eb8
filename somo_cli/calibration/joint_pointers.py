"""Where a document defines the joints of one axis of an actuator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import read
from somo_cli.problems import Pointer
from somo_cli.scene.actuation import driven_actuators, is_pressure


def pointers(document: Document, at: Pointer, actuator: int, axis: int) -> tuple[Pointer, ...]:
    """Return the pointers to the joint definitions of an axis, from base to tip.

    The definition at `at` is valid. All joints of the axis share one joint definition, except with
    planar_flag 2, where each joint has its own; fixed joints are then left out.
    """
    where: Pointer = (*at, "actuator_definitions", actuator)
    data: Any = document.at(where)
    joints = data["joint_definitions"]
    numbers: Sequence[int] = (axis,)
    if int(data.get("planar_flag", 1 if len(joints) == 1 else 0)) == 2:
        numbers = [n for n, joint in enumerate(joints) if joint.get("joint_type") != "fixed"]
    return tuple((*where, "joint_definitions", number) for number in numbers)


def under_pressure(document: Document, manipulator: int) -> set[tuple[int, int]]:
    """Return actuator and axis of all that pressure drives, in a manipulator of a valid scene."""
    data: Any = document.at(("manipulators", manipulator))
    definition = read.read(document, ("manipulators", manipulator, "definition"))
    return {
        (actuator, int(entry["axis"]))
        for entry in data.get("actuation", ())
        if is_pressure(entry)
        for actuator in driven_actuators(entry, definition)
    }


def values(places: Sequence[Pointer], key: str, wanted: Sequence[float]) -> Mapping[Pointer, float]:
    """Return the rounded values of a key of joint definitions, one for each definition.

    A definition that all joints share gets the value of the first joint; a single value is that of
    all definitions.
    """
    each = [wanted[0]] * len(places) if 1 in (len(places), len(wanted)) else wanted
    return {(*place, key): rounded(value) for place, value in zip(places, each, strict=True)}


def rounded(value: float) -> float:
    """Return a value rounded to nine digits, more than any gauge has, as a file shows it."""
    return float(f"{value:.9g}")
