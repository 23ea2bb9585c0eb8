"""Contact events to CSV as they come."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TextIO

from somo_cli.scene.contact_surface import GROUND_NAME
from somo_cli.simulation.monitoring.contact_events import ContactEvent
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
