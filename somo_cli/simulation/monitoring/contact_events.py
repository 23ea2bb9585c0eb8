"""When links begin and cease to touch each other: contacts as events in time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TextIO, TypeAlias

from somo_cli.manipulator.geometry import Vector
from somo_cli.scene.contact_surface import GROUND_NAME
from somo_cli.simulation.engine.contacts import ContactPoint, LinkIndex
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import UnitFactors, unit_factors_of

COLUMNS = (
    "time_s",
    "event",
    "first",
    "first_link",
    "second",
    "second_link",
    "x_m",
    "y_m",
    "z_m",
    "normal_n",
    "impulse_ns",
)

Pair: TypeAlias = tuple[LinkIndex, LinkIndex]


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """A pair of links that began or ceased to press on each other.

    At the beginning `normal` and `impulse` [engine units of force, times s] are those of its first
    step, at the end the largest and the sum of all steps in between; `point` is the middle of the
    contact, weighed by the forces, in the first or in the last step.
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
    """Compares what touches after each step with what did before."""

    def __init__(self, time_step: float, on_event: Callable[[ContactEvent], None]) -> None:
        self._time_step = time_step
        self._on_event = on_event
        self._present: dict[Pair, _OngoingContact] = {}

    def update(self, step: int, touches: Sequence[ContactPoint]) -> None:
        """Tell what has changed in the step that led to `step`, in the order of the pairs.

        A contact is there in the steps in which it presses: points that the engine keeps near
        each other without a force are none.
        """
        now = self._pressing_contacts(touches)
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

    def _pressing_contacts(self, touches: Sequence[ContactPoint]) -> dict[Pair, _OngoingContact]:
        found: dict[Pair, _OngoingContact] = {}
        for touch in touches:
            force = touch.normal_force
            if force <= 0:
                continue
            first, second = touch.first, touch.second
            pair = (first, second) if first <= second else (second, first)
            x, y, z = touch.point
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


class ContactEventWriter:
    """Writes a header and then events in SI to an open text stream, each as one line."""

    def __init__(self, stream: TextIO, plan: Plan) -> None:
        self._stream = stream
        self._units: UnitFactors = unit_factors_of(plan)
        self._time_step = plan.time_step
        self._names = plan.recorded.names
        self._links = [
            *([link.name for link in body.chain.links] for body in plan.bodies),
            *([link.name for link in planned.rigid_object.chain.links] for planned in plan.objects),
            [GROUND_NAME],
        ]
        self.events = 0
        self._write(COLUMNS)

    def write(self, event: ContactEvent) -> None:
        """Write one event."""
        length, force = self._units.length, self._units.force
        numbers = [
            *(value / length for value in event.point),
            event.normal / force,
            event.impulse / force,
        ]
        owners = [
            name
            for body, link in event.pair
            for name in (self._names[body], self._links[body][link])
        ]
        time = float(f"{event.step * self._time_step:.12g}")
        self._write([repr(time), event.kind, *owners, *map(repr, numbers)])
        self.events += 1

    def _write(self, cells: Sequence[str]) -> None:
        self._stream.write(",".join(cells) + "\n")
