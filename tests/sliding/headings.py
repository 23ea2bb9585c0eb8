"""Bodies that slide over the ground in every direction: how far they get, and how far aside."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from tests.truth.touching import G, last_row, with_cubes

HEADINGS = 16
SPEED = 1.17  # m/s
FRICTION = 0.35

PLATE = {"mesh": "meshes/angle_foot.obj", "mesh_scale": 0.001, "mass": 0.3}
BODIES: Mapping[str, Mapping[str, Any]] = {
    "cube": {"shape_type": "box", "dimensions": [0.1, 0.1, 0.1], "mass": 0.5},
    "slab": {"shape_type": "box", "dimensions": [0.1, 0.06, 0.04], "mass": 0.5},
    "plank": {"shape_type": "box", "dimensions": [0.2, 0.04, 0.02], "mass": 0.5},
    "disc": {"shape_type": "cylinder", "dimensions": [0.02, 0.05], "mass": 0.3},
    "coin": {"shape_type": "cylinder", "dimensions": [0.01, 0.05], "mass": 0.3},
    "capsule": {"shape_type": "capsule", "dimensions": [0.1, 0.02], "mass": 0.3},
    "mesh": {
        "shape_type": "mesh",
        "mesh": "meshes/angle_foot.obj",
        "mesh_scale": 0.001,
        "mass": 0.3,
    },
}
"""What slides; a capsule along its axis, or it would roll."""

HEIGHTS = {
    "cube": 0.05,
    "slab": 0.02,
    "plank": 0.01,
    "disc": 0.01,
    "coin": 0.005,
    "capsule": 0.02,
    "mesh": 0.0,
}
"""Of the frame over the ground [m]."""

MIDDLES = {"mesh": 0.015}
"""How far along its x axis the centre of mass of a body is from its frame [m], if it is."""


@dataclasses.dataclass(frozen=True, slots=True)
class Stop:
    """Where a body came to rest, over the distance v²/(2 μ g), and by how much it turned [rad]."""

    beyond: float
    aside: float
    turned: float


def stop(body: str, heading: float, yaw: float, step: float = 1e-3, speed: float = SPEED) -> Stop:
    """Return where a body stops that slides with this heading [rad] and yaw [rad]."""
    ahead = math.cos(heading), math.sin(heading)
    rpy = [0.0, math.pi / 2, heading] if body == "capsule" else [0.0, 0.0, yaw]
    centre = _turned(MIDDLES.get(body, 0.0), yaw)
    rigid_object = {
        **BODIES[body],
        "name": "slider",
        "friction": FRICTION,
        "position": [-centre[0], -centre[1], HEIGHTS[body]],
        "rpy": rpy,
        "linear_velocity": [speed * ahead[0], speed * ahead[1], 0.0],
    }
    end = last_row(with_cubes(rigid_object), step, 1.2 * speed / (FRICTION * G))
    x, y = end["slider.pose.x_m"], end["slider.pose.y_m"]
    turn = (
        0.0 if body == "capsule" else 2 * math.atan2(end["slider.pose.qz"], end["slider.pose.qw"])
    )
    middle = _turned(MIDDLES.get(body, 0.0), turn)
    x, y = x + middle[0], y + middle[1]
    distance = speed**2 / (2 * FRICTION * G)
    along, across = x * ahead[0] + y * ahead[1], y * ahead[0] - x * ahead[1]
    turned = 0.0 if body == "capsule" else math.remainder(turn - yaw, 2 * math.pi)
    return Stop(along / distance - 1, across / distance, turned)


def _turned(distance: float, yaw: float) -> tuple[float, float]:
    return distance * math.cos(yaw), distance * math.sin(yaw)
