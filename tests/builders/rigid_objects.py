"""Scenes of rigid objects, what they do, and what checks say of them."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from somo_cli.scene import columns
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import Data, X, actuator, manipulator
from tests.builders.runs import rows_of
from tests.builders.scene_problems import messages_of
from tests.builders.scenes import scene_from_text

G = 9.81  # m/s²

CUBE: Data = {
    "name": "cube",
    "shape_type": "box",
    "dimensions": [0.04, 0.04, 0.04],
    "mass": 0.01,
    "position": [0, 0, 0.02],
    "friction": 0.5,
}

BALL: Data = {"name": "ball", "shape_type": "sphere", "dimensions": [0.02], "mass": 0.05}

PILL: Data = {"name": "pill", "shape_type": "capsule", "dimensions": [0.06, 0.01], "density": 1000}

ROUNDED_CUBE: Data = {
    "name": "cube",
    "shape_type": "box",
    "dimensions": [0.06, 0.06, 0.06],
    "edge_radius": 0.005,
    "mass": 0.1,
}

PARTS = ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw", "fx_n", "fy_n", "fz_n", "normal_n")


def scene_of_objects(*objects: Data, **of_scene: Any) -> Data:
    """Return a scene of objects, and one manipulator that is far away."""
    one = {"definition": manipulator(actuator(1, X), world_scale=20), "position": [9, 9, 9]}
    record = {"every": 10, "columns": [], "objects": ["pose", "contact_force"]}
    return {"manipulators": [one], "objects": list(objects), "record": record, **of_scene}


def object_columns(data: Data, time: float) -> dict[str, dict[str, np.ndarray]]:
    """Return the columns of every object by its name, and the times as `t` of each."""
    pytest.importorskip("pybullet")
    scene = scene_from_text(json.dumps(data))
    rows = np.array(rows_of(scene, round(time / scene.time_step)))
    names = columns.header(make_plan(scene).recorded)
    found: dict[str, dict[str, np.ndarray]] = {}
    for name, values in zip(names[1:], rows.T[1:], strict=True):
        owner, _, part = name.split(".")
        found.setdefault(owner, {"t": rows[:, 0]})[part] = values
    assert all(tuple(one)[1:] == PARTS for one in found.values())
    return found


def object_problems(*objects: Data, **of_scene: Any) -> list[str]:
    """Return the messages of all problems of a scene of objects."""
    return messages_of(scene_of_objects(*objects, **of_scene))


SCALES = pytest.mark.parametrize("scale", [1, 20])


def slop(scale: float) -> float:
    """How deep the engine lets everything sink in: 10 µm in engine units, and 1e-5 of that."""
    return 1.00001e-5 / scale


def plan_with_plate(step: float = 1e-3) -> Plan:
    """Return a plan of a body at world scale 20 and a plate of 4 mm, with ground far below."""
    plate = {"name": "plate", "shape_type": "box", "dimensions": [0.1, 0.1, 0.004], "fixed": True}
    one = {"definition": manipulator(actuator(1, X), world_scale=20)}
    data = {"time_step": step, "manipulators": [one], "objects": [plate], "ground": {"height": -9}}
    return make_plan(scene_from_text(json.dumps(data)))
