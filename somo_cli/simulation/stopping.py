"""What may end a run before its last step: conditions as a scene has them, in SI."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from somo_cli.manipulator.dimensions import AngularRate, Length, Time, Velocity

AXES = ("x", "y", "z")
REST_TIME = 0.5  # s
REST_SPEED = 1e-4  # m/s
REST_RATE = 1e-3  # rad/s


@dataclass(frozen=True, slots=True)
class AtTime:
    """The run ends with the first step that is not before `time`."""

    time: Time


@dataclass(frozen=True, slots=True)
class Leaves:
    """It ends when the centre of an object is outside a box of the world, infinite where open."""

    thing: str
    lower: tuple[Length, Length, Length]
    upper: tuple[Length, Length, Length]


@dataclass(frozen=True, slots=True)
class AtRest:
    """It ends when all has been slow for so long, and not before `after` [s].

    Slow are joints and what turns freely below `rate`, centres of objects and free bases below
    `speed`.
    """

    duration: Time
    after: Time
    speed: Velocity
    rate: AngularRate


Stop: TypeAlias = AtTime | Leaves | AtRest


def stops(items: Sequence[Mapping[str, Any]]) -> tuple[Stop, ...]:
    """Return the conditions of a list without faults, in its order."""
    return tuple(map(_stop, items))


def _stop(data: Mapping[str, Any]) -> Stop:
    if "time" in data:
        return AtTime(float(data["time"]))
    if "at_rest" in data:
        rest = data["at_rest"]
        return AtRest(
            duration=float(rest.get("for", REST_TIME)),
            after=float(rest.get("after", 0)),
            speed=float(rest.get("speed", REST_SPEED)),
            rate=float(rest.get("rate", REST_RATE)),
        )
    box = [data["leaves"].get(axis, (-math.inf, math.inf)) for axis in AXES]
    lower, upper = zip(*((float(low), float(high)) for low, high in box), strict=True)
    return Leaves(str(data["object"]), lower, upper)
