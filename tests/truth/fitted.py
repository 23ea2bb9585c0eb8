"""A fit finds again the parameters of a scene from what a run of it recorded, with noise."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from somo_cli.calibration.fit import FitResult, SceneModel, fit
from somo_cli.calibration.measurement import Measurement, measurement
from somo_cli.calibration.parameters import PARAMETER_KINDS, ParameterKind, parameters
from somo_cli.document.table import read_table
from somo_cli.scene import columns
from somo_cli.scene.model import Scene
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.builders.definitions import Data, actuator, hinge, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text
from tests.truth.table import Row

TIP = ("tip.x_m", "tip.y_m", "tip.z_m")
PULSES = [[0, 0], [0.02, 0.012], [0.3, 0.012], [0.32, -0.01], [0.6, -0.01], [0.62, 0.004]]


def fitted_finger(stiffness: Sequence[float], damping: Sequence[float]) -> Data:
    """Return a finger of 0.1 m and 30 g in six joints, 15 g at its tip."""
    joints = [
        hinge(*axis, spring_stiffness=stiffness[number], spring_damping=damping[number])
        for number, axis in enumerate(((1, 0, 0), (0, 1, 0)))
    ]
    link = {"shape_type": "box", "dimensions": [0.02, 0.02, 0.1 / 6], "mass": 0.005}
    tip = {"shape_type": "sphere", "dimensions": [0.01], "mass": 0.015}
    body = actuator(6, *joints, link=link)
    return manipulator(body, world_scale=20, tip_definition=tip)


def driven_finger(
    stiffness: Sequence[float] = (0.1, 0.3),
    damping: Sequence[float] = (4e-4, 6e-4),
    gain: float = 1.0,
    stretch: float = 1.0,
    **of_scene: Any,
) -> Scene:
    drives = [
        {
            "actuator": 0,
            "axis": axis,
            "waypoints": [[stretch * time, size * gain * torque] for time, torque in PULSES],
        }
        for axis, size in ((0, 1.0), (1, 3.0))
    ]
    one = {"definition": fitted_finger(stiffness, damping), "actuation": drives}
    data = {"manipulators": [one], "record": {"every": 10}, "time_step": 1e-3, **of_scene}
    return scene_from_text(json.dumps(data))


def noisy_table(
    scene: Scene, steps: int, names: Sequence[str], noise: float = 0.0, seed: int = 1
) -> str:
    """Return the CSV of some columns of a run, with noise on all but the time."""
    header = [name.removeprefix("body.") for name in columns.header(make_plan(scene).recorded)]
    rows = np.array(rows_of(scene, steps))
    random = np.random.default_rng(seed)
    places = [header.index(name) for name in names]
    values = rows[:, places] + noise * random.standard_normal((len(rows), len(names)))
    lines = [",".join(["time_s", *names])]
    for time, row in zip(rows[:, 0], values, strict=True):
        lines.append(",".join(map(repr, [float(time), *map(float, row)])))
    return "\n".join(lines)


def fitted(
    guess: Scene, text: str, kinds: Sequence[ParameterKind] = PARAMETER_KINDS
) -> tuple[FitResult, Measurement]:
    measured = measurement(read_table(text, "a.csv"), guess, ())
    model = SceneModel(guess, measured, BulletWorld, lambda runs: None)
    return fit(model, measured, list(parameters(guess.manipulators[0], kinds))), measured


GUESS: dict[str, Any] = {"stiffness": (0.14, 0.22), "damping": (8e-4, 3e-4), "gain": 1.3}
TRUTH = {"stiffness": (0.1, 0.3), "damping": (4e-4, 6e-4), "gain": (1 / 1.3, 1 / 1.3)}


def relative_errors(found: FitResult) -> dict[str, float]:
    """Return the relative error of every parameter."""
    return {
        one.name: value / TRUTH[one.kind][one.axis] - 1
        for one, value in zip(found.parameters, found.values, strict=True)
    }


def noisy(seed: int = 1) -> str:
    """Return one second of a tip seen by a camera at 100 Hz, with 0.1 mm of noise."""
    return noisy_table(driven_finger(), 1000, TIP, noise=1e-4, seed=seed)


def halves(text: str) -> dict[str, str]:
    """Return a measurement, its first half, and every second row of it."""
    header, *rows = text.split("\n")
    parts = {
        "101 rows": rows,
        "the first 50": rows[: len(rows) // 2],
        "every second": rows[::2],
    }
    return {name: "\n".join([header, *part]) for name, part in parts.items()}


def rows() -> Iterator[Row]:
    """Yield the largest relative error of six parameters over four recordings each."""
    worst: dict[str, float] = {}
    for seed in range(4):
        for name, text in halves(noisy(seed)).items():
            found, _ = fitted(driven_finger(**GUESS), text)
            largest = max(map(abs, relative_errors(found).values()))
            worst[name] = max(worst.get(name, 0.0), largest)
    what = "fit of six parameters, 0.1 mm of noise: largest relative error in four recordings"
    for name, error in worst.items():
        yield Row(what, name, "40 % off", error, 0.0, error)
