"""One case of cases.yaml, and its scene: the shipped finger taken to an extreme."""

from __future__ import annotations

import copy
import dataclasses
import functools
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from somo_cli.document.parse import Document, parse
from somo_cli.loading import load_text, scene_of
from somo_cli.scene.model import Integrator
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import natural_frequencies
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.scenes import DEFINITIONS

CASES = Path(__file__).with_name("cases.yaml")


@dataclass(frozen=True, slots=True)
class Case:
    """A case as cases.yaml has it, where the fields are described."""

    name: str
    joints: int = 10
    stiffness: float = 1.0
    damping: float | Sequence[float] = 0.03
    time_step: float = 1e-3
    steps: int = 1000
    size: float = 1.0
    length: float = 1.0
    width: float = 1.0
    link_mass: float = 1.0
    tip_mass: float = 1.0
    base_mass: float = 1.0
    neutral: float = 0.0
    limit: float = math.pi
    gravity: Sequence[float] = (0.0, 0.0, -9.81)
    world_scale: float | dict[str, float] = 20.0
    base: str = "static"
    bend: float = 0.0
    perturb: float = 0.02
    rates: float = 0.0
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    spin: Sequence[float] = (0.0, 0.0, 0.0)
    torque: Sequence[float] = (0.0, 0.0)

    @property
    def is_damped(self) -> bool:
        """Whether every joint has a damper."""
        return min(self._dampings) > 0

    @property
    def is_passive(self) -> bool:
        """Whether nothing but gravity does work on it."""
        return not any(self.torque)

    @property
    def keeps_momentum(self) -> bool:
        """Whether no force acts on it from outside."""
        return self.base == "free" and not any(self.gravity)

    @property
    def _dampings(self) -> tuple[float, float]:
        pair = self.damping if isinstance(self.damping, Sequence) else (self.damping,) * 2
        return pair[0], pair[1]

    def plan(self, integrator: Integrator, time_step: float, every: int) -> Plan:
        """Return the plan of this case with another integrator and step [s]."""
        scene = dataclasses.replace(
            scene_of(self.document)[0],
            integrator=integrator,
            time_step=time_step,
            every=every,
            columns=("joint_angles", "energy"),
        )
        return make_plan(scene)

    @property
    def document(self) -> Document:
        """The scene as a document, for what is said of it beforehand."""
        return _document(self._scene(self._damping_times()))

    def _damping_times(self) -> tuple[float, float]:
        """Return damping over stiffness [s] of either axis: 2 ζ / ω of the slowest mode."""
        scene, _ = scene_of(_document(self._scene((0.0, 0.0))))
        (finger,) = scene.manipulators
        chain = ChainDynamics(finger.compiled.chain)
        inertia = chain.at(finger.initial_angles).joint_inertia(self.base == "free")
        slowest = natural_frequencies(inertia, chain.stiffness)[0]
        first, second = (float(2 * ratio / slowest) for ratio in self._dampings)
        return first, second

    def _scene(self, damping_times: tuple[float, float]) -> dict[str, Any]:
        # irrational multiples: no plane of symmetry, and no mode left out
        wave = np.sin(1 + 2.7 * np.arange(self.joints))
        finger = {
            "definition": self._definition(damping_times),
            "base": self.base,
            "initial_angles": (self.bend + self.perturb * wave).tolist(),
            "initial_rates": self.rates,
            "actuation": [
                {"actuator": 0, "axis": axis, "torque": torque}
                for axis, torque in enumerate(self.torque)
                if torque
            ],
        }
        if self.base == "free":
            finger |= {"linear_velocity": self.velocity, "angular_velocity": self.spin}
        return {
            "time_step": self.time_step,
            "gravity": self.gravity,
            "world_scale": self.world_scale,
            "manipulators": [finger],
        }

    def _definition(self, damping_times: tuple[float, float]) -> dict[str, Any]:
        finger = copy.deepcopy(_finger())
        (actuator,) = finger["actuator_definitions"]
        whole = actuator["n_segments"]
        per_joint, volume = whole / self.joints, self.size**3
        across, along = self.size * self.width, self.size * self.length * per_joint
        link = actuator["link_definition"]
        x, y, height = link["dimensions"]
        link["dimensions"] = [x * across, y * across, height * along]
        link["mass"] *= volume * per_joint * self.link_mass
        actuator["n_segments"] = self.joints
        for joint, time in zip(actuator["joint_definitions"], damping_times, strict=True):
            joint["spring_stiffness"] *= volume * self.stiffness / per_joint
            joint["spring_damping"] = joint["spring_stiffness"] * time
            joint["joint_neutral_position"] = self.neutral
            joint["limits"][:2] = [-self.limit, self.limit]
            _stretch(joint, "neutral_axis_offset", across)
        base, tip = finger["base_definition"], finger["tip_definition"]
        base["mass"] *= volume * self.base_mass
        tip["mass"] *= volume * self.tip_mass
        for part in (base, tip):
            _stretch(part, "dimensions", self.size)
            _stretch(part, "origin_offset", self.size)
        if self.tip_mass == 0:
            del finger["tip_definition"]
        return finger


def read_cases() -> tuple[Case, ...]:
    """Return every case of the table."""
    data: Any = parse(CASES.read_text("utf-8"), str(CASES)).data
    return tuple(
        Case(f"{group}: {name}", **fields)
        for group, cases in data.items()
        for name, fields in cases.items()
    )


def _document(scene: dict[str, Any]) -> Document:
    return load_text(json.dumps(scene), str(DEFINITIONS / "extreme.yaml"))


@functools.cache
def _finger() -> dict[str, Any]:
    path = DEFINITIONS / "finger.yaml"
    data: Any = parse(path.read_text("utf-8"), str(path)).data
    return dict(data)


def _stretch(mapping: dict[str, Any], key: str, factor: float) -> None:
    if key in mapping:
        mapping[key] = [value * factor for value in mapping[key]]
