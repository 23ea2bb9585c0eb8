"""The law without the prediction of contact forces, as it was before: the bench compares to it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from unittest import mock

from somo_cli.simulation import loop
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.engine.pressing import ContactReader
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.contact_prediction import PredictionCount
from somo_cli.simulation.plan.model import Plan


class PlainLaw:
    """Applies the torques of all bodies, and reads nothing of contact."""

    def __init__(
        self, plan: Plan, world: World, reader: ContactReader, steppers: Sequence[BodyStepper]
    ) -> None:
        del plan, world, reader
        self._steppers = steppers
        self.count = PredictionCount()

    def apply(self, is_check: bool) -> None:
        """Apply the torques of the coming step; `is_check` if motion is checked at its start."""
        for stepper in self._steppers:
            (stepper.apply_at_check if is_check else stepper.apply_torques)()


@contextmanager
def without_prediction() -> Iterator[None]:
    """Have runs that start meanwhile predict no contact forces."""
    with mock.patch.object(loop, "ContactPrediction", PlainLaw):
        yield
