"""A world in a few lines: joints that know nothing of each other, and of no gravity."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Hashable, Sequence
from typing import Any

import numpy as np

from somo_cli.manipulator.geometry import ZERO, Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.engine.contacts import ContactPoint, LinkIndex
from somo_cli.simulation.engine.interface import WorldObject
from somo_cli.simulation.engine.pressing import (
    ContactPair,
    ContactReader,
    Pair,
    PressingForces,
    PressingPoints,
)
from somo_cli.simulation.integrator.energy_bound import BodyEnergy
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.joint_springs import JointSprings
from somo_cli.simulation.plan.model import Body, Plan
from tests.builders.definitions import actuator, hinge, manipulator
from tests.builders.scenes import scene_from_text

HINGE_INERTIA = 0.5  # kg·m²
HINGE_STIFFNESS = 20.0  # N·m/rad
HINGE_DAMPING = 0.3  # N·m·s/rad
HINGE_NEUTRAL = 0.1  # rad


def plan_of_hinges(count: int = 1, names: Sequence[str] = ("a",), **more: Any) -> Plan:
    """Return a plan whose bodies are chains of equal hinges, bent by a torque of 1 N·m.

    What belongs to a manipulator goes into `one`, the rest into the scene.
    """
    joint = hinge(
        1, 0, 0,
        spring_stiffness=HINGE_STIFFNESS,
        spring_damping=HINGE_DAMPING,
        joint_neutral_position=HINGE_NEUTRAL,
    )  # fmt: skip
    one = {
        "definition": manipulator(actuator(count, joint)),
        "actuation": [{"actuator": 0, "axis": 0, "torque": 1.0}],
        **more.pop("one", {}),
    }
    manipulators = [{"name": name, **one} for name in names]
    return make_plan(scene_from_text(json.dumps({"manipulators": manipulators, **more})))


def energy_of_hinge(gravity: float = 0.0, **start: object) -> BodyEnergy:
    """Return the energy of one hinge of `plan_of_hinges`, with changes of its start."""
    body = plan_of_hinges(1).bodies[0]
    body = dataclasses.replace(body, start=dataclasses.replace(body.start, **start))  # type: ignore[arg-type]
    springs = JointSprings(np.array([HINGE_STIFFNESS]), np.zeros(1), np.array([HINGE_NEUTRAL]))
    return BodyEnergy(body, springs, (0.0, 0.0, -gravity))


class FakeBody:
    """Joints of equal inertia under a constant load [N·m]; `torques` are the last ones applied."""

    def __init__(self, body: Body, time_step: float, load: float = 0.0) -> None:
        self._start = body.start
        self._time_step = time_step
        self._load = load
        self.angles = np.array(body.start.angles)
        self.rates = np.array(body.start.rates)
        self.torques = np.zeros_like(self.angles)
        self.mass_matrices = 0
        self.apply: Callable[[Sequence[float]], None] = self._apply
        self.joint_states: Callable[[], Sequence[Any]] = self._joint_states

    def _joint_states(self) -> Sequence[Any]:
        pairs = zip(self.angles.tolist(), self.rates.tolist(), strict=True)
        return [(angle, rate, (), 0.0) for angle, rate in pairs]

    def _apply(self, torques: Sequence[float]) -> None:
        self.torques = np.array(torques)

    def step(self) -> None:
        self.rates = self.rates + self._time_step * (self.torques + self._load) / HINGE_INERTIA
        self.angles = self.angles + self._time_step * self.rates
        self.torques = np.zeros_like(self.angles)

    def mass_matrix(self, angles: Sequence[float]) -> np.ndarray:
        self.mass_matrices += 1
        return HINGE_INERTIA * np.eye(len(angles))

    def bias(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        spin: Sequence[float] = (),
        centre: Pose | None = None,
    ) -> np.ndarray:
        return np.zeros(len(angles))

    def equivalent_joint_torques(self, forces: np.ndarray) -> np.ndarray:
        return forces

    def to_base_axes(self, forces: np.ndarray) -> np.ndarray:
        raise AssertionError("a base that cannot move has no axes of interest")

    def apply_base_wrench(self, wrench: np.ndarray, centre: Pose | None = None) -> None:
        raise AssertionError("a base that cannot move is not pushed")

    def base_inertial_pose(self) -> Pose:
        raise AssertionError("a base that cannot move is where it was")

    def base_pose(self) -> Pose:
        return Pose()

    def base_velocity(self) -> tuple[Vector, Vector]:
        return ZERO, ZERO

    def reset(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        self.angles, self.rates = np.array(angles), np.array(rates)


class NothingNear:
    """Reads the contact points of a world that has none."""

    recovery = 0.0

    def pressing(self) -> Sequence[Hashable] | None:
        return None

    def pairs(self) -> Sequence[Pair]:
        raise AssertionError("nothing presses")

    def follow(self, kept: Sequence[int]) -> None:
        raise AssertionError("nothing presses")

    def forces(self) -> PressingForces:
        raise AssertionError("nothing presses")

    def points(self) -> PressingPoints:
        raise AssertionError("nothing presses")

    def pair(self, pair: Pair) -> ContactPair:
        raise AssertionError("nothing touches")


class FakeWorld:
    """Calls `at_step[n]` after its n-th step; `rates` are those of the first body after each."""

    def __init__(self, plan: Plan, load: float = 0.0) -> None:
        self.bodies = [FakeBody(body, plan.time_step, load) for body in plan.bodies]
        self.objects: list[WorldObject] = []
        self.depths: list[tuple[LinkIndex, LinkIndex, float]] = []
        self.at_step: dict[int, Callable[[], None]] = {}
        self.steps = 0
        self.rates: list[np.ndarray] = []
        self.step: Callable[[], object] = self._step

    def contact_points(self) -> list[ContactPoint]:
        return []

    def penetrations(self) -> Sequence[tuple[LinkIndex, LinkIndex, float]]:
        return self.depths

    def normal_forces(self) -> dict[tuple[int, int], float]:
        return {}

    def contact_reader(self) -> ContactReader:
        return NothingNear()

    def claim_engine(self) -> None:
        """Share nothing."""

    def adapt_solver_iterations(self) -> None:
        """Have no solver."""

    def _step(self) -> None:
        for body in self.bodies:
            body.step()
        self.steps += 1
        self.rates.append(self.bodies[0].rates)
        self.at_step.get(self.steps, lambda: None)()
