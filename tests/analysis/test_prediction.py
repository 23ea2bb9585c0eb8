"""What is predicted of a step, against runs: hardly ever too good, and not absurdly bad."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from somo_cli.analysis.prediction import left_by
from somo_cli.analysis.stability import outlook_of, predicted_error, recommended_step
from somo_cli.simulation import signal
from somo_cli.simulation.plan import make_plan
from somo_cli.simulation.scene import Integrator, Scene
from tests.loading import rows_of, scene_from_file, scene_from_text
from tests.simulation.test_physics import THROWN

DURATION, EVERY = 1.0, 0.02  # s


def struck(torque: float) -> Scene:
    return scene_from_text(
        "manipulators:\n  - definition: finger.yaml\n    actuation:\n"
        f"      - {{actuator: 0, axis: 0, torque: {torque}}}\n"
        f"      - {{actuator: 0, axis: 1, torque: {torque}}}\n"
    )


SCENES = {
    "shipped finger": scene_from_file("scene.yaml"),
    "shipped arm": scene_from_file("arm_scene.yaml"),
    "shipped cantilever": scene_from_file("cantilever_scene.yaml"),
    "shipped planar finger": scene_from_file("planar_finger_scene.yaml"),
    "shipped three-axis finger": scene_from_file("three_axis_finger_scene.yaml"),
    "shipped snake": scene_from_file("snake_scene.yaml"),
    "let go": scene_from_file("finger.yaml"),
    "struck": struck(0.05),
    "touched": struck(0.01),
    "thrown": scene_from_text(THROWN + "    actuation: [{actuator: 0, axis: 0, torque: 0.03}]\n"),
}
STEPS: dict[Integrator, tuple[float, ...]] = {"implicit": (1e-2, 2e-3), "euler": (5e-3, 1e-3)}
PESSIMISM = 250.0  # of the three-axis finger, whose swings are linear; the others stay below 60


def tips(scene: Scene, integrator: Integrator, step: float) -> np.ndarray:
    scene = dataclasses.replace(
        scene,
        integrator=integrator,
        time_step=step,
        every=round(EVERY / step),
        columns=("tip_position",),
    )
    return np.array(rows_of(scene, round(DURATION / step)))[:, 1:]


@pytest.mark.parametrize("name", SCENES)
def test_no_run_is_worse_than_predicted(name: str) -> None:
    scene = SCENES[name]
    plan = make_plan(scene)
    outlooks = [outlook_of(plan, body) for body in plan.bodies]
    length = scene.manipulators[0].compiled.chain.length
    fine = tips(scene, "implicit", 2e-4)
    for integrator, steps in STEPS.items():
        for step in steps:
            off = np.linalg.norm(tips(scene, integrator, step) - fine, axis=1).max() / length
            told = predicted_error(outlooks, integrator, step)
            assert 0.9 * min(off, 1.0) < told < PESSIMISM * off, (integrator, step, off, told)


@pytest.mark.parametrize("name", SCENES)
def test_the_recommended_step_keeps_to_a_percent(name: str) -> None:
    scene = SCENES[name]
    step = recommended_step(make_plan(scene))
    assert step in [digit * 10**power for digit in (1, 2, 5) for power in range(-6, -1)] or (
        step == pytest.approx(float(f"{step:.0e}"), rel=1e-15)
    )
    length = scene.manipulators[0].compiled.chain.length
    step_of_rows = step if (EVERY / step).is_integer() else EVERY / math.ceil(EVERY / step)
    fine = tips(scene, "implicit", 2e-4)
    off = np.linalg.norm(tips(scene, "implicit", step_of_rows) - fine, axis=1).max() / length
    assert off < 0.01


def test_a_jump_leaves_all_and_a_slow_ramp_little() -> None:
    frequencies = np.array([1.0, 10.0, 100.0])
    jump = signal.through([(0.0, 3.0)], "linear", False)
    assert left_by(jump, frequencies) == pytest.approx([3, 3, 3])
    later = signal.through([(0.0, 0.0), (1.0, -2.0)], "step", False)
    assert left_by(later, frequencies) == pytest.approx([2, 2, 2])
    ramp = signal.through([(0.0, 0.0), (2.0, 1.0)], "linear", False)
    # of a ramp of length T a mode keeps sin(ω t/2) / (ω T/2) of the last t
    expected = [math.sin(1.0), 1 / 10, 1 / 100]
    assert left_by(ramp, frequencies) == pytest.approx(expected, rel=0.02)
    smooth = signal.through([(0.0, 0.0), (2.0, 1.0)], "cubic", False)
    assert left_by(smooth, frequencies)[2] < 0.02
    still = signal.through([(0.0, 0.0)], "linear", False)
    assert left_by(still, frequencies) == pytest.approx([0, 0, 0])


def test_what_nothing_moves_is_let_go_sideways() -> None:
    scene = scene_from_file("cantilever_scene.yaml", "manipulators[0].loads=[]")
    plan = make_plan(scene)
    (body,) = plan.bodies
    motion = outlook_of(plan, body).motion
    # a cantilever of 0.3 kg and EI = 1 N·m² under its own weight: w L⁴ / 8 EI, most in one mode
    assert motion.amplitudes.max() == pytest.approx(0.3 * 9.81 / 8, rel=0.03)
    assert motion.error("implicit", 0.05) > 0


def test_several_bodies_take_the_smallest_step() -> None:
    one = "{definition: finger.yaml}"
    stiff = (
        "{definition: finger.yaml, name: quick, actuation: [{actuator: 0, axis: 0, torque: 0.05}]}"
    )
    alone = recommended_step(make_plan(scene_from_text(f"manipulators: [{one}]")))
    both = recommended_step(make_plan(scene_from_text(f"manipulators: [{one}, {stiff}]")))
    assert both < alone
