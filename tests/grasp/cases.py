"""The grasps of the bench, SI: fingers of two segments that hang around an object on the ground."""

from __future__ import annotations

import dataclasses
import json
import math
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np

from somo_cli.scene.model import Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import natural_frequencies
from tests.builders.definitions import actuator, chain_of, hinge, manipulator
from tests.builders.scenes import scene_from_text

Data = dict[str, Any]
Shape = Literal["ball", "cube", "capsule"]
Integrator = Literal["implicit", "euler"]
Task = Literal["held", "lifted", "released", "sliding", "handed over"]

RADIUS = 0.03  # m: half the size of the object
BASE = 0.115  # m: height of the bases over the ground
AWAY = 0.045  # m: from the axis of the object to that of a finger
TORQUE = 0.05  # N m, in every joint
SEGMENTS = ((0.022, 0.018, 0.00424, 0.3175524), (0.018, 0.014, 0.0027, 0.1222452))
CLOSED = 0.7  # s
SETTLED = 1.6  # s: when what is done with the object is over
END = 2.4  # s
GRIP = 2.8  # N, of three fingers with this torque
LOAD = 0.2  # of what friction could hold of an object: heavier ones are held in less gravity


@dataclass(frozen=True, slots=True)
class Grasp:
    """One case: `mass_ratio` is the object's mass over the effective mass of a fingertip."""

    task: Task = "held"
    fingers: int = 3
    mass_ratio: float = 10.0
    damping_ratio: float = 0.1
    shape: Shape = "ball"
    integrator: Integrator = "implicit"
    spinning: float = 0.0  # m, moment arm of the fingers' friction against spinning
    rolling: float = 0.0  # m, and against rolling

    @property
    def name(self) -> str:
        """What the tables call it."""
        parts = [
            f"{self.shape} {self.task}, {self.fingers} fingers, mass x {self.mass_ratio:g}",
            f"damping {self.damping_ratio:g}",
        ]
        parts += ["euler"] * (self.integrator == "euler")
        parts += [f"spinning {1e3 * self.spinning:g} mm"] * (self.spinning > 0)
        parts += [f"rolling {1e3 * self.rolling:g} mm"] * (self.rolling > 0)
        return ", ".join(parts)

    @property
    def has_mirror_images(self) -> bool:
        """Whether rounding decides to which of two sides the object gives way."""
        return self.fingers == 2

    @property
    def mass(self) -> float:
        """Mass of the object [kg]."""
        return self.mass_ratio * tip_mass()

    def scene(self, step: float) -> Scene:
        """Return the scene at a time step [s], a row every 2 ms."""
        data = {
            "ground": {"friction": 1},
            "manipulators": self._hands(),
            "objects": [self._object()],
        }
        gravity = min(9.81, LOAD * GRIP * self._friction / self.mass)
        data["gravity"] = [0, 0, -gravity]
        data["record"] = {"columns": ["contact_force"], "objects": ["pose", "contact_force"]}
        scene = scene_from_text(json.dumps(data))
        every = max(1, round(2e-3 / step))
        return dataclasses.replace(scene, time_step=step, every=every, integrator=self.integrator)

    @property
    def _friction(self) -> float:
        return 0.3 if self.task == "sliding" else 1.0

    def _hands(self) -> list[Data]:
        return [self._finger(number) for number in range(self.fingers)]

    def _finger(self, number: int) -> Data:
        turn = 2 * math.pi * number / self.fingers
        data: Data = {
            "name": f"finger_{number}",
            "definition": finger(self.damping_ratio),
            "base": "constrained",
            "position": [AWAY * math.sin(turn), -AWAY * math.cos(turn), BASE],
            "rpy": [math.pi, 0, turn],
            "surface": {
                "friction": self._friction,
                "spinning_friction": self.spinning,
                "rolling_friction": self.rolling,
            },
            "actuation": [{"actuators": "all", "axis": 0, "waypoints": self._torque(number)}],
        }
        if self.task in ("lifted", "released", "sliding", "handed over"):
            path = 0.01 if self.task == "sliding" else 0.05
            data["motion"] = {"translation": [[0.9, 0, 0, 0], [1.4, 0, 0, path]]}
        return data

    def _torque(self, number: int) -> list[list[float]]:
        closing = [[0.1, 0.0], [CLOSED, TORQUE]]
        if self.task == "released":
            return [*closing, [1.5, TORQUE], [SETTLED, 0.0]]
        if self.task == "handed over":
            if number % 2:
                return [[1.0, 0.0], [1.3, TORQUE]]
            return [[0.1, 0.0], [0.6, TORQUE], [1.4, TORQUE], [SETTLED, 0.0]]
        return closing

    def _object(self) -> Data:
        kind: dict[Shape, Data] = {
            "ball": {"shape_type": "sphere", "dimensions": [RADIUS]},
            "cube": {"shape_type": "box", "dimensions": [2 * RADIUS] * 3},
            "capsule": {"shape_type": "capsule", "dimensions": [2 * RADIUS, RADIUS]},
        }
        data = {"name": "object", "mass": self.mass, "friction": 1, "position": [0, 0, 0]}
        return data | kind[self.shape] | {"place": {"on": "ground"}}


def finger(damping_ratio: float) -> Data:
    """Return the definition of a finger whose lowest mode has a damping ratio."""
    damping = 2 * damping_ratio / lowest_mode()
    return manipulator(
        *(
            actuator(
                5,
                hinge(
                    1,
                    0,
                    0,
                    limits=[-1.5, 1.5, 1, 10],
                    spring_stiffness=stiffness,
                    spring_damping=damping * stiffness,
                ),
                link={"shape_type": "box", "dimensions": [wide, deep, 0.01], "mass": mass},
                planar_flag=1,
            )
            for wide, deep, mass, stiffness in SEGMENTS
        ),
        world_scale=20,
    )


@cache
def lowest_mode() -> float:
    """Return the lowest natural frequency of a finger [rad/s], straight and without gravity."""
    return float(natural_frequencies(_inertia(), _undamped().stiffness)[0])


@cache
def tip_mass() -> float:
    """Return what the tip weighs [kg] to a push sideways."""
    (jacobian,) = _undamped().at(np.zeros(10)).tip_jacobians()
    return float(1 / (jacobian[1] @ np.linalg.solve(_inertia(), jacobian[1])))


def _inertia() -> np.ndarray:
    return _undamped().at(np.zeros(10)).joint_inertia()


@cache
def _undamped() -> ChainDynamics:
    data = manipulator(
        *(
            actuator(
                5,
                hinge(1, 0, 0, spring_stiffness=stiffness),
                link={"shape_type": "box", "dimensions": [wide, deep, 0.01], "mass": mass},
                planar_flag=1,
            )
            for wide, deep, mass, stiffness in SEGMENTS
        ),
        world_scale=20,
    )
    return ChainDynamics(chain_of(data))


RATIOS = (0.1, 1.0, 10.0, 100.0)
DAMPINGS = (0.02, 0.05, 0.1, 0.5)
ENDS = DAMPINGS[0], DAMPINGS[-1]


def cases() -> tuple[Grasp, ...]:
    """Return every case of the bench: a grid of mass and damping, then all else one by one."""
    grid = [Grasp(mass_ratio=ratio, damping_ratio=one) for ratio in RATIOS for one in DAMPINGS]
    tasks: tuple[Task, ...] = ("lifted", "released", "sliding")
    others = [Grasp(task) for task in tasks[:2]]
    others += [Grasp(task, 4, shape="cube") for task in tasks[1:]]
    others += [Grasp("handed over", 4, shape="cube")]
    others += [Grasp(fingers=count) for count in (2, 4)]
    others += [Grasp(fingers=2, shape="cube")]
    shapes: tuple[Shape, ...] = ("cube", "capsule")
    others += [Grasp(task, 4, shape=shape) for shape in shapes for task in ("held", "lifted")]
    light, heavy = ({"mass_ratio": one} for one in (0.1, 100.0))
    others += [Grasp(task, 4, shape="cube", **one) for task in tasks for one in (light, heavy)]
    others += [Grasp(task, 4, damping_ratio=one, shape="cube") for task in tasks for one in ENDS]
    others += [Grasp(task, 4, shape="capsule") for task in tasks[1:]]
    others += [Grasp("sliding"), Grasp("lifted", 2, shape="cube")]
    others += [Grasp(integrator="euler"), Grasp("lifted", 4, shape="cube", integrator="euler")]
    others += [Grasp(spinning=0.01), Grasp("lifted", 4, spinning=0.01)]
    others += [Grasp(rolling=0.003), Grasp(fingers=2, rolling=0.003)]
    return (*grid, *others)
