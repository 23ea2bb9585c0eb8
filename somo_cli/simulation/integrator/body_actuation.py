"""The torques and loads that act on one body: those of the scene, and torques that a user sets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.external_loads import ExternalLoads
from somo_cli.simulation.plan.model import Body


class BodyActuation:
    """Fills in the torque of every joint in a step; `loads` are None where the scene has none."""

    def __init__(self, body: Body, torques: Array, loads: ExternalLoads | None) -> None:
        self.torques = torques
        """The actuation torque of each joint in engine units, shape (n,); loads are not in it."""
        self.loads = loads
        self._drives = body.drives
        self._setters = [(drive.signal.at, _setter(torques, drive.joints)) for drive in body.drives]
        self._given: dict[tuple[int, ...], _GivenTorque] = {}
        self._time = 0.0

    def set_torques(self, time: float) -> None:
        """Set the torques of a time [s]."""
        self._time = time
        for at, put in self._setters:
            put(at(time))
        if self._given:
            for given in self._given.values():
                given.put(given.torque)

    def give_torque(self, joints: tuple[int, ...], torque: float, factor: float) -> None:
        """Apply a torque [N·m] to joints from the next `set_torques` on.

        It replaces what the scene says, until another torque is given. `factor` leads to engine
        units.
        """
        self._given[joints] = _GivenTorque(_setter(self.torques, joints), factor * torque, torque)

    def si_torques(self) -> Array:
        """Return the actuation torque of each joint in the present step [N·m], shape (n,)."""
        torques: Array = np.zeros(len(self.torques))
        for drive in self._drives:
            torques[list(drive.joints)] = drive.si_signal.at(self._time)
        for joints, given in self._given.items():
            torques[list(joints)] = given.si_torque
        return torques

    def constant_until(self, time: float) -> float:
        """Return the time [s] up to which torques and loads stay as they are at `time`."""
        until = math.inf if self.loads is None else self.loads.constant_until(time)
        for drive in self._drives:
            if until <= time:  # no other can be steady for less
                return until
            until = min(until, drive.signal.constant_until(time))
        return until


@dataclass(frozen=True, slots=True)
class _GivenTorque:
    """A torque from outside [engine units and N·m], and the function that sets it on its joints."""

    put: Callable[[float], None]
    torque: float
    si_torque: float


def _setter(values: Array, joints: tuple[int, ...]) -> Callable[[float], None]:
    """Return the function that sets the values of these joints to one number."""
    steps = {after - before for before, after in itertools.pairwise(joints)}
    if len(steps) > 1:
        return partial(values.__setitem__, np.array(joints))
    # evenly spaced ones are a view, which is filled in half of the time
    view: Array = values[joints[0] : joints[-1] + 1 : steps.pop() if steps else 1]
    return view.fill
