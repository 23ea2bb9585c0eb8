"""Finds contact forces that keep varying while nothing drives them, and contact lost that way.

With damping in its joints a body at rest comes to rest: what swings dies away. A normal force that
swings as much after `WINDOWS` windows of time as before, about a mean that stays, is made by the
method. So is contact that is lost meanwhile.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.engine.contacts import BodyPair
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.monitoring.findings import Finding, half_step_hint
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of

WINDOWS = 4
MIN_SAMPLES = 16  # in a window
MIN_WINDOW = 0.1  # s
LEAST_CROSSINGS = 8  # of the mean in all windows: slower swings decay too little to be judged
LARGEST_DEVIATION = 0.005  # of the mean force, as a standard deviation about a straight line
LEAST_DECAY = 0.95  # of the deviation, from the first window to the last
LARGEST_DRIFT = 0.1  # of the mean force, from the first window to the last: it is driven by motion
FINE_STEPS = 256  # sampled one by one, to count the periods


@dataclass(slots=True)
class _PairForce:
    """The normal forces between two bodies, sampled at checks [engine units]."""

    samples: list[float] = field(default_factory=list)
    absent: int = 0
    """Samples in a row without contact."""
    count: int = 0


class ContactShakingMonitor:
    """Samples normal forces between bodies while nothing drives them."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._names = plan.recorded.names
        seconds = MONITORING_INTERVAL * plan.time_step
        self._window = max(MIN_SAMPLES, math.ceil(MIN_WINDOW / seconds))
        self._forces: dict[BodyPair, _PairForce] = {}
        self._shaking: dict[BodyPair, list[float]] = {}  # forces of the steps after it was found
        self.findings: dict[tuple[str, BodyPair], Finding] = {}

    @property
    def wants_every_step(self) -> bool:
        """Whether forces are to be sampled in each of the coming steps, by `sample`."""
        return any(len(forces) < FINE_STEPS for forces in self._shaking.values())

    def update(self, time: float, now: Mapping[BodyPair, float], is_driven: bool) -> None:
        """Sample the normal forces at a check, at a time [s]; a scene that is driven starts anew.

        It is driven if actuation, loads or a prescribed motion have changed since the last check.
        """
        if is_driven:
            self._forces.clear()
            return
        for pair in now:
            self._forces.setdefault(pair, _PairForce())
        for pair, one in list(self._forces.items()):
            force = now.get(pair, 0.0)
            one.samples.append(force)
            one.count += 1
            one.absent = one.absent + 1 if force == 0 else 0
            if one.absent > self._window:
                if ("contact-shakes", pair) in self.findings:
                    self._find_lost(time, pair)
                del self._forces[pair]
            elif len(one.samples) > WINDOWS * self._window:
                del one.samples[0]
                is_due = one.count % (self._window // 2) == 0
                if is_due and ("contact-shakes", pair) not in self.findings:
                    self._judge(time, pair, np.array(one.samples))

    def sample(self, now: Mapping[BodyPair, float]) -> None:
        """Sample the normal forces of one step, after `wants_every_step`."""
        for pair, forces in self._shaking.items():
            if len(forces) < FINE_STEPS:
                forces.append(now.get(pair, 0.0))
                if len(forces) == FINE_STEPS:
                    self._name_frequency(pair, np.array(forces))

    def _judge(self, time: float, pair: BodyPair, samples: Array) -> None:
        windows = samples.reshape(WINDOWS, -1)
        means = windows.mean(axis=1)
        mean = float(means.mean())
        deviations = np.array([_deviation(one) for one in windows])
        is_steady = abs(means[-1] - means[0]) < LARGEST_DRIFT * mean
        is_large = bool((deviations > LARGEST_DEVIATION * mean).all())
        lasts = bool((deviations[-1] >= LEAST_DECAY * deviations[:-1]).all())
        if not (is_steady and is_large and lasts and len(_crossings(samples)) > LEAST_CROSSINGS):
            return
        newton = unit_factors_of(self._plan).force
        first, second = (self._names[number] for number in pair)
        deviation = float(deviations.mean()) / newton
        self.findings["contact-shakes", pair] = Finding(
            "contact-shakes",
            time,
            (first, second),
            f"from {time - self._duration:.4g} s on the force between '{first}' and '{second}' "
            f"keeps varying by {deviation:.3g} N about {mean / newton:.3g} N, and nothing drives "
            "it",
            half_step_hint(self._plan.time_step),
            (("deviation_n", deviation), ("mean_n", mean / newton)),
        )
        self._shaking[pair] = []

    def _name_frequency(self, pair: BodyPair, forces: Array) -> None:
        crossings = _crossings(forces)
        if len(crossings) < 3:
            return  # so slow that its periods cannot be counted
        half_periods = (len(crossings) - 1) / (crossings[-1] - crossings[0])
        frequency = half_periods / (2 * self._plan.time_step)
        key = "contact-shakes", pair
        before = self.findings[key]
        self.findings[key] = replace(
            before,
            message=f"{before.message} (about {frequency:.2g} times a second)",
            values=(*before.values, ("frequency_hz", frequency)),
        )

    def _find_lost(self, time: float, pair: BodyPair) -> None:
        first, second = (self._names[number] for number in pair)
        began = time - self._window * MONITORING_INTERVAL * self._plan.time_step
        self.findings.setdefault(
            ("contact-lost", pair),
            Finding(
                "contact-lost",
                began,
                (first, second),
                f"at {began:.4g} s '{first}' and '{second}' lost contact as the force between them "
                "shook",
                half_step_hint(self._plan.time_step),
            ),
        )

    @property
    def _duration(self) -> float:
        return WINDOWS * self._window * MONITORING_INTERVAL * self._plan.time_step


def _detrended(values: Array) -> Array:
    """Return values, shape (n,), less the straight line that fits them best."""
    at = np.arange(len(values)) - 0.5 * (len(values) - 1)
    centred = values - values.mean()
    detrended: Array = centred - at * (at.dot(centred) / at.dot(at))
    return detrended


def _deviation(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(_detrended(values)))))


def _crossings(values: Array) -> list[int]:
    """Return where values cross the straight line that fits them best, as indices."""
    indices: list[int] = np.flatnonzero(np.diff(_detrended(values) > 0)).tolist()
    return indices
