"""Contact events: when two links begin and cease to press on each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.engine.contacts import ContactPoint, LinkIndex

Pair: TypeAlias = tuple[LinkIndex, LinkIndex]
"""Two links, the lower number first."""


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """Two links that began or ceased to press on each other at a step.

    `normal` is a force [engine units] and `impulse` a force times s. At the beginning they are
    those of the first step, at the end the largest force and the whole impulse. `point` is the
    centre of the contact points, weighted by their normal forces, in the first or last step.
    """

    step: int
    kind: Literal["begin", "end"]
    pair: Pair
    point: Vector
    normal: float
    impulse: float


@dataclass(slots=True)
class _OngoingContact:
    point: Vector
    normal: float
    largest: float
    impulse: float


class ContactMonitor:
    """Compares the contacts of each step with those of the step before."""

    def __init__(self, time_step: float, on_event: Callable[[ContactEvent], None]) -> None:
        self._time_step = time_step
        self._on_event = on_event
        self._present: dict[Pair, _OngoingContact] = {}

    def update(self, step: int, points: Sequence[ContactPoint]) -> None:
        """Pass on every contact that began or ended in the step that led to `step`, in order.

        Only points with a normal force count: the engine also keeps points that are merely near.
        """
        now = self._pressing_contacts(points)
        before = self._present
        if not now and not before:
            return
        for pair in sorted(now.keys() | before.keys()):
            if pair not in before:
                one = now[pair]
                self._on_event(
                    ContactEvent(step, "begin", pair, one.point, one.normal, one.impulse)
                )
            elif pair not in now:
                one = before[pair]
                self._on_event(ContactEvent(step, "end", pair, one.point, one.largest, one.impulse))
            else:
                one, last = now[pair], before[pair]
                one.largest = max(one.largest, last.largest)
                one.impulse += last.impulse
        self._present = now

    def _pressing_contacts(self, points: Sequence[ContactPoint]) -> dict[Pair, _OngoingContact]:
        found: dict[Pair, _OngoingContact] = {}
        for contact in points:
            force = contact.normal_force
            if force <= 0:
                continue
            first, second = contact.first, contact.second
            pair = (first, second) if first <= second else (second, first)
            x, y, z = contact.point
            one = found.get(pair)
            if one is None:
                found[pair] = _OngoingContact((x, y, z), force, force, force * self._time_step)
                continue
            normal = one.normal + force
            share = force / normal
            ox, oy, oz = one.point
            one.point = (ox + share * (x - ox), oy + share * (y - oy), oz + share * (z - oz))
            one.normal = one.largest = normal
            one.impulse = normal * self._time_step
        return found
