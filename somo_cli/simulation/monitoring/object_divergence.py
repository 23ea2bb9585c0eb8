"""Whether free objects move as they cannot: too fast to be followed, or with too much energy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn, Protocol

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.monitoring.object_motion import ObjectMotion
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of


class EnergeticBody(Protocol):
    """What has been put into one body."""

    @property
    def energy(self) -> BodyEnergy:
        """Its energy, and the bound of it."""

    def gravity_work(self) -> float:
        """Return what gravity has given it, where its `input_energy` does not count that."""


def check_objects(
    step: int,
    plan: Plan,
    objects: Sequence[ObjectMotion],
    bodies: Sequence[EnergeticBody],
    object_energy: float,
    max_ratio: float,
) -> None:
    """Raise SimulationDiverged if objects have more kinetic energy than was put into the scene.

    They may have `max_ratio` times as much; `object_energy` bounds what objects have added. It is
    counted closely, without what gravity could give to bodies that fell as far as they can, because
    one light object in a heavy scene may be fast enough to be useless with little of it. An object
    that turns too far in a step counts as diverged, too, and so does a state that is NaN.
    """
    for one in objects:
        angle = one.rate * plan.time_step
        if not angle < one.max_angle:
            _raise_object_diverged(step, plan, one, f"it turns {angle:.3g} rad in one step")
    bound = max_ratio * (object_energy + sum(one.energy.input_energy for one in bodies))
    bound += sum(one.energy.floor for one in bodies) + sum(one.floor for one in objects)
    # what is quick to tell comes first, and is enough but for what is suspicious
    if sum(one.energy_bound for one in objects) <= bound:
        return
    energies = [one.energy() for one in objects]
    if not sum(energies) <= bound + max_ratio * sum(max(0.0, one.gravity_work()) for one in bodies):
        culprit = objects[int(np.argmax(energies))]
        speed = geometry.norm(culprit.world_object.velocity()[0]) / unit_factors_of(plan).length
        _raise_object_diverged(
            step,
            plan,
            culprit,
            f"it moves at {speed:.3g} m/s and turns at {culprit.rate:.3g} rad/s, with more energy "
            "than was put in",
        )


def _raise_object_diverged(step: int, plan: Plan, one: ObjectMotion, reason: str) -> NoReturn:
    hint = f"try half the step, --time-step {plan.time_step / 2:g}"
    raise SimulationDiverged(step, step * plan.time_step, one.name, reason, hint, "object")
