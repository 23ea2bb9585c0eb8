"""The conditions that end a run before its last step, in SI."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

from somo_cli.manipulator.dimensions import AngularRate, Length, Time, Velocity

AXIS_NAMES = ("x", "y", "z")
DEFAULT_REST_DURATION = 0.5  # s
DEFAULT_REST_SPEED = 1e-4  # m/s
DEFAULT_REST_RATE = 1e-3  # rad/s

FindingCode: TypeAlias = Literal[
    "contact-energy",
    "contact-lost",
    "contact-missed",
    "contact-shakes",
    "contact-unpredicted",
    "deep-penetration",
]
"""What a run may find of contact that no rigid body does, or that it cannot follow well."""
FINDING_CODES: tuple[FindingCode, ...] = get_args(FindingCode)
ANY_FINDING = "any"


@dataclass(frozen=True, slots=True)
class StopAtTime:
    """End the run with the first step at or after `time` [s]."""

    time: Time


@dataclass(frozen=True, slots=True)
class StopOutsideBox:
    """End the run when the origin of an object's frame leaves a box along the world's axes [m].

    A bound is infinite if the scene does not give it.
    """

    object_name: str
    lower: tuple[Length, Length, Length]
    upper: tuple[Length, Length, Length]


@dataclass(frozen=True, slots=True)
class StopAtRest:
    """End the run when everything has been at rest for `duration` [s], not before `after` [s].

    At rest means: the rates of joints and the angular velocities of objects and moving bases are
    below `rate` [rad/s], and the velocities of objects and moving bases below `speed` [m/s].
    """

    duration: Time
    after: Time
    speed: Velocity
    rate: AngularRate


@dataclass(frozen=True, slots=True)
class StopOnFinding:
    """It ends when the run has found one of these."""

    codes: tuple[str, ...]


StopCondition: TypeAlias = StopAtTime | StopOutsideBox | StopAtRest | StopOnFinding


def read_stop_conditions(items: Sequence[Mapping[str, Any]]) -> tuple[StopCondition, ...]:
    """Return the conditions of a list without errors, in its order."""
    return tuple(map(_read_stop_condition, items))


def _read_stop_condition(data: Mapping[str, Any]) -> StopCondition:
    if "time" in data:
        return StopAtTime(float(data["time"]))
    if "findings" in data:
        codes = data["findings"]
        return StopOnFinding(FINDING_CODES if codes == ANY_FINDING else tuple(map(str, codes)))
    if "at_rest" in data:
        rest = data["at_rest"]
        return StopAtRest(
            duration=float(rest.get("for", DEFAULT_REST_DURATION)),
            after=float(rest.get("after", 0)),
            speed=float(rest.get("speed", DEFAULT_REST_SPEED)),
            rate=float(rest.get("rate", DEFAULT_REST_RATE)),
        )
    box = [data["leaves"].get(axis, (-math.inf, math.inf)) for axis in AXIS_NAMES]
    lower, upper = zip(*((float(low), float(high)) for low, high in box), strict=True)
    return StopOutsideBox(str(data["object"]), lower, upper)
