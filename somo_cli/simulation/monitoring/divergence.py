"""The divergence monitor: ends a run whose numbers have lost their meaning.

It judges by energy and speed, since the numbers of a diverging run stay finite for long.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NoReturn, Protocol

import numpy as np

from somo_cli.arrays import Array
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.dynamics.modal import largest_explicit_step
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.monitoring.base_divergence import check_bases
from somo_cli.simulation.monitoring.object_divergence import check_objects
from somo_cli.simulation.monitoring.object_motion import ObjectMotion
from somo_cli.simulation.plan.model import Body, Plan

MAX_ANGLE_PER_STEP = math.pi  # rad; beyond, a joint's motion cannot be told from its alias
# energy over what was put in; an integrator at its accuracy limit stays well below 2
MAX_ENERGY_RATIO = 4.0
# the explicit integrator keeps E - h v K q / 2, so its energy may grow to (1 + x) / (1 - x) times
# what was put in, where x = h ω / 2 is its share of the stability limit; this is x = 0.96
MAX_ENERGY_RATIO_EXPLICIT = 50.0


class BodyInMotion(Protocol):
    """What the divergence monitor needs of one body in motion."""

    @property
    def body(self) -> Body:
        """The body, as planned."""

    @property
    def energy(self) -> BodyEnergy:
        """Its energy, and the bound of it."""

    @property
    def max_rate(self) -> float:
        """The rate of its fastest joint [rad/s]."""

    @property
    def mass(self) -> Array:
        """The joint-space inertia, shape (n, n)."""

    @property
    def mass_at_start(self) -> Array:
        """The joint-space inertia at the start, shape (n, n)."""

    @property
    def rates(self) -> Array:
        """Joint rates, shape (n,)."""


class MeasurableBody(BodyInMotion, Protocol):
    """A body whose speed and energy can be measured."""

    @property
    def base_rate(self) -> float:
        """The angular velocity of its base [rad/s] if nothing holds that, else 0."""

    def gravity_work(self) -> float:
        """Return what gravity has given it, where its `input_energy` does not count that."""

    def measure(self) -> None:
        """Measure speed and energy at the present instant."""


@dataclass(frozen=True, slots=True)
class StateHistory:
    """One body in several rows: angles [rad] and rates [rad/s], shape (rows, n), and inertias."""

    angles: Array
    rates: Array
    masses: Sequence[Array]


class DivergenceMonitor:
    """Checks bodies in motion at the monitoring interval, and rows before they are written.

    `object_energy` returns an upper bound on the energy that objects have added so far. Work is
    counted in every step, so the verdict does not depend on what is recorded.
    """

    def __init__(
        self,
        plan: Plan,
        bodies: Sequence[MeasurableBody],
        object_energy: Callable[[], float] = lambda: 0.0,
        objects: Sequence[ObjectMotion] = (),
    ) -> None:
        self._plan = plan
        self._bodies = bodies
        self._objects = objects
        self._read_object_energy = object_energy
        self._object_energy = 0.0

    def update(self, step: int) -> None:
        """Measure every body; raise SimulationDiverged as `check` does."""
        for one in self._bodies:
            one.measure()
        for moving in self._objects:
            moving.measure()
        self._object_energy = self._read_object_energy()
        check(step, self._plan, self._bodies, self._object_energy)
        check_bases(step, self._plan, self._bodies)
        if self._objects:
            ratio = _max_energy_ratio(self._plan)
            check_objects(step, self._plan, self._objects, self._bodies, self._object_energy, ratio)

    def count_valid_rows(self, rows: int, histories: Sequence[StateHistory]) -> int:
        """Return the number of rows before the first invalid one; histories of all bodies."""
        present, max_rate = np.zeros(rows), np.zeros(rows)
        for one, history in zip(self._bodies, histories, strict=True):
            present += one.energy.energies(history.angles, history.rates, history.masses)
            np.maximum(max_rate, np.abs(history.rates).max(axis=1), out=max_rate)
        bound = _bound(self._plan, self._bodies, self._object_energy)
        is_valid = (max_rate < MAX_ANGLE_PER_STEP / self._plan.time_step) & (present <= bound)
        return rows if is_valid.all() else int(is_valid.argmin())

    def raise_diverged(self, step: int, histories: Sequence[StateHistory], row: int) -> NoReturn:
        """Raise SimulationDiverged for the state of a body in a row, recorded at a step."""
        _raise_diverged(
            step,
            self._plan,
            [
                _state_in_row(one, history, row)
                for one, history in zip(self._bodies, histories, strict=True)
            ],
        )


def check(
    step: int, plan: Plan, bodies: Sequence[BodyInMotion], object_energy: float = 0.0
) -> None:
    """Raise SimulationDiverged if the energy of all bodies exceeds its bound.

    It is summed over the bodies, because contact moves energy from one to another;
    `object_energy` bounds what objects have added. A joint that turns by more than
    MAX_ANGLE_PER_STEP in one step counts as diverged, too. Without bodies there is nothing to say.
    """
    if not bodies:
        return
    limit = MAX_ANGLE_PER_STEP / plan.time_step
    present = sum(one.energy.present for one in bodies)
    is_fast = not all(one.max_rate < limit for one in bodies)
    if is_fast or not present <= _bound(plan, bodies, object_energy):
        _raise_diverged(step, plan, bodies)


def _bound(plan: Plan, bodies: Sequence[BodyInMotion], object_energy: float) -> float:
    ratio = _max_energy_ratio(plan)
    return ratio * object_energy + sum(
        ratio * one.energy.bound + one.energy.floor for one in bodies
    )


def _max_energy_ratio(plan: Plan) -> float:
    return MAX_ENERGY_RATIO_EXPLICIT if plan.integrator == "explicit" else MAX_ENERGY_RATIO


@dataclass(frozen=True, slots=True)
class _RowState:
    body: Body
    energy: BodyEnergy
    max_rate: float
    mass: Array
    mass_at_start: Array
    rates: Array


def _state_in_row(one: BodyInMotion, history: StateHistory, row: int) -> _RowState:
    angles, rates, mass = history.angles[row], history.rates[row], history.masses[row]
    energy = copy.copy(one.energy)
    energy.update(angles, rates, mass)
    return _RowState(one.body, energy, float(np.abs(rates).max()), mass, one.mass_at_start, rates)


def _raise_diverged(step: int, plan: Plan, bodies: Sequence[BodyInMotion]) -> NoReturn:
    fast = next(
        (one for one in bodies if not one.max_rate * plan.time_step < MAX_ANGLE_PER_STEP), None
    )
    if fast is not None:
        culprit = fast
        joint = _index_of_largest(np.abs(fast.rates))
        angle = abs(float(fast.rates[joint])) * plan.time_step
        reason = f"it turns {angle:.3g} rad in one step"
    else:
        culprit = max(bodies, key=lambda one: one.energy.present)
        joint = _index_of_largest(culprit.energy.joint_shares(culprit.rates, culprit.mass))
        available = sum(max(one.energy.bound, one.energy.floor) for one in bodies)
        present = sum(one.energy.present for one in bodies)
        reason = f"the energy is {present / available:.3g} times what was put in"
    body = culprit.body
    raise SimulationDiverged(
        step,
        step * plan.time_step,
        f"{body.name}.{body.chain.joints[joint].name}",
        reason,
        _advice(plan, body, culprit.mass_at_start),
    )


def _index_of_largest(values: Array) -> int:
    """Return the index of the largest value; NaN counts as the largest."""
    return int(np.argmax(np.where(np.isfinite(values), values, np.inf)))


def _advice(plan: Plan, body: Body, mass: Array) -> str:
    if plan.integrator == "explicit" and np.isfinite(mass).all():
        stiffness = np.array([joint.stiffness for joint in body.chain.joints])
        damping = [joint.damping for joint in body.chain.joints]
        largest = largest_explicit_step(mass, stiffness, damping)
        return (
            f"the explicit integrator is stable below a step of {largest:.3g} s at the start; "
            "use integrator: implicit, or such a step"
        )
    if plan.integrator == "implicit":
        return f"try half the step, --time-step {plan.time_step / 2:g}, or integrator: euler"
    return f"try half the step, --time-step {plan.time_step / 2:g}"
