"""What `run --error` reports of a run, against the error that it has."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np

from somo_cli.analysis import closed_forms
from somo_cli.scene.model import Integrator, Scene
from tests.bench.accuracy import MOTIONS, driven_finger, driven_finger_in_mujoco
from tests.builders import pendulum
from tests.builders.runs import estimated_errors, rows_of
from tests.truth.table import Row

STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4)
WHAT = "largest error that run --error reports, over the true one"


def rows() -> Iterator[Row]:
    """Yield the ratio for a hinge, whose closed form is known, and for the finger of the bench."""
    for integrator in ("implicit", "euler", "explicit"):
        for step in STEPS:
            yield of_hinge(integrator, step)
    for title, torque in MOTIONS.items():
        scene = driven_finger(torque)
        truth = driven_finger_in_mujoco(scene)
        for integrator in ("implicit", "euler"):
            for step in STEPS:
                yield of_finger(title.partition(":")[0], scene, truth, integrator, step)


def of_hinge(integrator: Integrator, step: float) -> Row:
    """Return the ratio for the damped hinge, at every hundredth of a second."""
    scene = dataclasses.replace(pendulum.pendulum_scene(integrator, step), every=round(0.01 / step))
    found = np.array(rows_of(scene, round(1 / step)))
    exact = 0.3 + closed_forms.oscillator(
        found[:, 0], pendulum.PENDULUM_INERTIA, 0.5, 50.0, (-0.3, 0.0)
    )
    true = float(np.abs(found[:, 1] - exact).max())
    return _row(f"hinge, {integrator}", step, reported_errors(scene)[0], true)


def of_finger(
    name: str, scene: Scene, truth: np.ndarray, integrator: Integrator, step: float
) -> Row:
    """Return the ratio for the worst joint of the finger, at every tenth of a second."""
    scene = dataclasses.replace(
        scene, integrator=integrator, time_step=step, every=round(0.1 / step)
    )
    found = np.array(rows_of(scene, round(1 / step)))[1:, 1:]
    true = float(np.abs(found - truth).max())
    return _row(f"{name} finger, {integrator}", step, float(reported_errors(scene).max()), true)


def reported_errors(scene: Scene) -> np.ndarray:
    """Return the largest error over one second that is reported of each column."""
    found = estimated_errors(scene, round(1 / scene.time_step))
    return np.array([error.maximum for error in found.errors])


def _row(case: str, step: float, ours: float, true: float) -> Row:
    return Row(WHAT, case, f"{step:g} s", ours, true, ours / true)
