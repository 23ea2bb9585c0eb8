"""Random contact scenes that nobody tuned: fingers, snakes and objects at extremes, from a seed."""

from __future__ import annotations

import json
import math
import random
from dataclasses import dataclass
from typing import Any, TypeAlias

from somo_cli.document.parse import Document
from somo_cli.loading import load_text
from tests.builders.scenes import DEFINITIONS

SceneData: TypeAlias = dict[str, Any]

STEPS = (2.5e-4, 5e-4, 1e-3, 2e-3, 4e-3, 8e-3)  # s


@dataclass(frozen=True, slots=True)
class RandomScene:
    """A scene as plain data, its name, and how long it runs [s]."""

    name: str
    data: SceneData
    duration: float

    @property
    def time_step(self) -> float:
        """The time step [s]."""
        return float(self.data["time_step"])

    def document(self, divisor: int = 1) -> Document:
        """Return the scene as a document, at its time step over `divisor`."""
        data = {**self.data, "time_step": self.time_step / divisor}
        return load_text(json.dumps(data), str(DEFINITIONS / f"{self.name}_scene.yaml"))


def random_scenes(count: int, seed: int = 1) -> list[RandomScene]:
    """Return scenes of every family in turn; the same for the same seed."""
    families = (_grasp, _thrown, _dropped, _struck, _crushed, _crawler)
    scenes = []
    for number in range(count):
        draw = random.Random(f"{seed}/{number}")
        family = families[number % len(families)]
        data, duration = family(draw)
        data["time_step"] = draw.choice(STEPS)
        data.setdefault(
            "record", {"every": 10, "columns": ["tip_position"], "objects": ["pose", "velocity"]}
        )
        scenes.append(RandomScene(f"{number:03d}{family.__name__}", data, duration))
    return scenes


def _log(draw: random.Random, low: float, high: float) -> float:
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def _object(draw: random.Random, size: float) -> SceneData:
    """Return a ball, box, capsule or cylinder of about a size [m], a hundred to 8000 kg/m³."""
    shape = draw.choice(("sphere", "box", "capsule", "cylinder"))
    dimensions = {
        "sphere": [size / 2],
        "box": [size, size * draw.uniform(0.5, 1.5), size * draw.uniform(0.5, 1.5)],
        "capsule": [size, size * draw.uniform(0.2, 0.5)],
        "cylinder": [size * draw.uniform(0.3, 1.5), size / 2],
    }[shape]
    return {
        "name": "object",
        "shape_type": shape,
        "dimensions": dimensions,
        "density": _log(draw, 50, 8000),
        "friction": _log(draw, 0.05, 2),
    }


def _ground(draw: random.Random) -> SceneData:
    ground: SceneData = {"friction": draw.uniform(0.1, 1)}
    if draw.random() < 0.25:
        ground |= {"contact_stiffness": _log(draw, 300, 3e4), "contact_damping": _log(draw, 1, 100)}
    return ground


def _closing(draw: random.Random) -> list[SceneData]:
    end, most = draw.choice((0.02, 0.1, 0.4)), _log(draw, 2e4, 3e5)
    waypoints = [[0.1, 0], [0.1 + end, most]]
    return [{"actuator": 0, "axis": 0, "input": "pressure", "waypoints": waypoints}]


def _grasp(draw: random.Random) -> tuple[SceneData, float]:
    """Two to four fingers close round an object and lift it."""
    count, lift = draw.choice((2, 3, 4)), draw.choice((0, 0.05, 0.2))
    radius = draw.uniform(0.04, 0.055)
    fingers = []
    actuation = _closing(draw)
    for number in range(count):
        angle = 2 * math.pi * number / count
        fingers.append(
            {
                "name": f"finger{number}",
                "definition": "finger.yaml",
                "base": "constrained",
                "position": [radius * math.sin(angle), -radius * math.cos(angle), 0.135],
                "rpy": [math.pi, 0, angle],
                "surface": {"friction": _log(draw, 0.2, 2)},
                "actuation": actuation,
                "motion": {"translation": [[0.6, 0, 0, 0], [0.9, 0, 0, lift]]},
            }
        )
    thing = _object(draw, draw.uniform(0.025, 0.045))
    thing |= {"position": [0, 0, 0], "place": {"on": "ground"}}
    return {"ground": _ground(draw), "manipulators": fingers, "objects": [thing]}, 1.2


def _thrown(draw: random.Random) -> tuple[SceneData, float]:
    """An object flies at a standing finger."""
    speed = _log(draw, 0.3, 30)
    thing = _object(draw, draw.uniform(0.01, 0.06))
    thing |= {
        "position": [draw.uniform(-0.01, 0.01), -0.2, draw.uniform(0.04, 0.12)],
        "linear_velocity": [0, speed, 0],
        "angular_velocity": [draw.uniform(-30, 30) for _ in range(3)],
    }
    finger = {"definition": "finger.yaml", "position": [0, 0, 0]}
    return {"ground": _ground(draw), "manipulators": [finger], "objects": [thing]}, 0.6


def _dropped(draw: random.Random) -> tuple[SceneData, float]:
    """Objects fall on a snake that lies on the ground."""
    things = []
    for number in range(draw.choice((1, 2, 3))):
        thing = _object(draw, draw.uniform(0.01, 0.08))
        thing |= {
            "name": f"object{number}",
            "position": [0.05 * number, 0.02, 0.2 + 0.2 * number],
            "rpy": [draw.uniform(-3, 3) for _ in range(3)],
        }
        things.append(thing)
    snake = {
        "definition": "snake.yaml",
        "base": "free",
        "position": [0, 0, 0.1],
        "rpy": [0, 1.5707963267948966, 0],
        "surface": {"friction": draw.uniform(0.1, 1)},
    }
    return {"ground": _ground(draw), "manipulators": [snake], "objects": things}, 0.8


def _struck(draw: random.Random) -> tuple[SceneData, float]:
    """A finger whose base is moved fast strikes an object on the ground."""
    way, took = draw.uniform(0.1, 0.3), _log(draw, 0.02, 0.5)
    thing = _object(draw, draw.uniform(0.02, 0.06))
    thing |= {"position": [0, 0.1, 0], "place": {"on": "ground"}}
    finger = {
        "definition": "finger.yaml",
        "base": "constrained",
        "position": [0, 0, 0.13],
        "rpy": [math.pi, 0, 0],
        "motion": {"translation": [[0.1, 0, 0, 0], [0.1 + took, 0, way, 0]]},
    }
    return {"ground": _ground(draw), "manipulators": [finger], "objects": [thing]}, 0.8


def _crushed(draw: random.Random) -> tuple[SceneData, float]:
    """A heavy object falls on a finger that stands, or lies across the ground."""
    thing = _object(draw, draw.uniform(0.02, 0.1))
    thing |= {"position": [draw.uniform(-0.01, 0.01), draw.uniform(-0.01, 0.01), 0.3]}
    stands = draw.random() < 0.5
    finger: SceneData = {"definition": "finger.yaml", "position": [0, 0, 0]}
    if not stands:
        finger |= {"position": [0, 0.05, 0.06], "rpy": [1.5707963267948966, 0, 0]}
    return {"ground": _ground(draw), "manipulators": [finger], "objects": [thing]}, 0.8


def _crawler(draw: random.Random) -> tuple[SceneData, float]:
    """A free finger falls on the ground and writhes, in a fast rhythm."""
    period = _log(draw, 0.02, 0.5)
    torque = _log(draw, 0.01, 0.3)
    actuation = {
        "actuator": 0,
        "axis": 0,
        "wave": {"shape": "sine", "amplitude": torque, "frequency": 1 / period},
    }
    finger = {
        "definition": "finger.yaml",
        "base": "free",
        "position": [0, 0, 0.05],
        "rpy": [1.5707963267948966, draw.uniform(-3, 3), draw.uniform(-3, 3)],
        "surface": {"friction": draw.uniform(0.1, 1)},
        "actuation": [actuation],
    }
    return {"ground": _ground(draw), "manipulators": [finger]}, 0.8
