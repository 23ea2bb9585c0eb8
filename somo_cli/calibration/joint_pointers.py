"""Where in a document the joints of one axis of an actuator are written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import read
from somo_cli.problems import Pointer
from somo_cli.scene.actuation import driven_actuators, is_pressure


def pointers(document: Document, at: Pointer, actuator: int, axis: int) -> tuple[Pointer, ...]:
    """Return the pointers to the joint definitions of an axis, base to tip.

    The definition at `at` has no faults. It is one definition for all the joints of the axis, but
    for planar_flag 2, which has one for each.
    """
    where: Pointer = (*at, "actuator_definitions", actuator)
    data: Any = document.at(where)
    count = len(data["joint_definitions"])
    is_each = int(data.get("planar_flag", 1 if count == 1 else 0)) == 2
    numbers = range(count) if is_each else (axis,)
    return tuple((*where, "joint_definitions", number) for number in numbers)


def under_pressure(document: Document, manipulator: int) -> set[tuple[int, int]]:
    """Return actuator and axis of all that pressure drives in a scene without faults."""
    data: Any = document.at(("manipulators", manipulator))
    definition = read.read(document, ("manipulators", manipulator, "definition"))
    return {
        (actuator, int(entry["axis"]))
        for entry in data.get("actuation", ())
        if is_pressure(entry)
        for actuator in driven_actuators(entry, definition)
    }


def values(
    places: Sequence[Pointer], key: str, first: float, profile: Sequence[float] | None = None
) -> Mapping[Pointer, float]:
    """Return what to write for a key of joint definitions: `first` times the profile, if any."""
    factors = profile if profile is not None and len(places) > 1 else [1.0] * len(places)
    return {
        (*place, key): rounded(first * float(factor))
        for place, factor in zip(places, factors, strict=True)
    }


def rounded(value: float) -> float:
    """Return a value to nine digits, which is more than any gauge has, and what a file shows."""
    return float(f"{value:.9g}")
