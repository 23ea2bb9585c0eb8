"""Modes and the explicit limit: against closed forms, against oracles, and against runs."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from somo_cli.analysis.stability import Outlook, outlook_of
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.plan import make_plan
from somo_cli.simulation.scene import Scene
from tests.loading import rows_of, scene_from_file, scene_from_text
from tests.simulation.test_physics import HINGE, INERTIA, JOINTS, THROWN

CUT = "manipulators[0].definition.actuator_definitions[0]"


def outlook(scene: Scene) -> Outlook:
    plan = make_plan(scene)
    return outlook_of(plan, plan.bodies[0])


def beam(n: int, damping: float = 0.0) -> Scene:
    """Return the cantilever of 0.3 kg and EI = 1 N·m² in n joints, as thin as a line."""
    return scene_from_file(
        "cantilever_scene.yaml",
        f"{CUT}.n_segments={n}",
        f"{CUT}.link_definition.dimensions=[1e-5, 1e-5, {1 / n!r}]",
        f"{CUT}.link_definition.mass={0.3 / n!r}",
        f"{CUT}.joint_definitions[0].spring_stiffness={n}",
        f"{CUT}.joint_definitions[0].spring_damping={damping}",
        "manipulators[0].loads=[]",
    )


# Frequencies of a chain of n slender rods with rotary inertia, joints at (i - 1/2) L/n, in units
# of sqrt(EI / (ρ A L⁴)); the beam has 3.51601526850015. Eigenvalues, computed with 15 digits.
@pytest.mark.parametrize(
    ("n", "first", "last"),
    [(3, 3.607808961845903, 77.69493129334919)],
)
def test_a_chain_vibrates_as_computed(n: int, first: float, last: float) -> None:
    unit = math.sqrt(1 / 0.3)
    found = outlook(beam(n)).modes["start"].frequencies / unit
    assert found[0] == pytest.approx(first, rel=1e-8)
    assert found[-1] == pytest.approx(last, rel=1e-6)


def test_chains_near_the_beam_with_second_order() -> None:
    unit = math.sqrt(1 / 0.3)
    errors = []
    for n in (5, 10, 20, 40):
        first = outlook(beam(n)).modes["start"].frequencies[0] / unit
        errors.append(first / 3.51601526850015 - 1)
    # 9.3e-3, 2.3e-3, 5.7e-4, 1.4e-4
    assert errors == pytest.approx([9.3e-3, 2.3e-3, 5.7e-4, 1.4e-4], rel=0.05)
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2, abs=0.05)


def test_the_explicit_step_of_a_fine_chain_goes_with_the_square_of_its_joints() -> None:
    """0.2255 / n² sqrt(ρ A L⁴ / EI), without damping."""
    n = 40
    found = outlook(beam(n)).explicit_step
    assert found == pytest.approx(0.2255 / n**2 * math.sqrt(0.3), rel=0.01)


def test_one_hinge_has_its_frequency_and_its_ratio() -> None:
    scene = dataclasses.replace(scene_from_text(HINGE), gravity=(0.0, 0.0, 0.0))
    found = outlook(scene)
    omega = math.sqrt(50 / INERTIA)
    zeta = 0.5 / (2 * math.sqrt(50 * INERTIA))
    assert found.modes["start"].frequencies == pytest.approx([omega])
    assert found.modes["start"].ratios == pytest.approx([zeta])
    # symplectic Euler: h ω = 2 (sqrt(1 + ζ²) - ζ)
    assert found.explicit_step * omega == pytest.approx(2 * (math.sqrt(1 + zeta**2) - zeta))


def test_gravity_stiffens_what_hangs_and_softens_what_stands() -> None:
    upright = scene_from_text(HINGE, f"{JOINTS.replace('manipulators[0].definition.', '')}[0]"
                              ".joint_neutral_position=0")  # fmt: skip
    hanging = dataclasses.replace(
        upright,
        manipulators=(dataclasses.replace(upright.manipulators[0], rpy=(math.pi, 0.0, 0.0)),),
    )
    weight = 1.0 * 9.81 * 0.5  # N·m/rad: 1 kg, its centre half a metre from the hinge
    for scene, sign in ((upright, -1), (hanging, 1)):
        modes = outlook(scene).modes["start"]
        assert modes.frequencies**2 == pytest.approx([(50 + sign * weight) / INERTIA])
        assert not modes.topples
    soft = scene_from_text(HINGE.replace("spring_stiffness: 50", "spring_stiffness: 4"))
    assert outlook(soft).modes["start"].topples


def survives(scene: Scene, step: float, steps: int) -> bool:
    try:
        rows_of(dataclasses.replace(scene, time_step=step, every=steps), steps)
    except SimulationDiverged:
        return False
    return True


def finger(*sets: str, base: str = "static") -> Scene:
    text = f"manipulators: [{{definition: finger.yaml, base: {base}}}]\n"
    return dataclasses.replace(
        scene_from_text(
            text + "integrator: explicit\n",
            "manipulators[0].initial_angles=0.001",
            *sets,
        ),
        gravity=(0.0, 0.0, 0.0),
    )


CASES = {
    "shipped": finger(),
    "undamped": finger(*(f"{JOINTS}[{axis}].spring_damping=0" for axis in (0, 1))),
    "damped heavily": finger(*(f"{JOINTS}[{axis}].spring_damping=0.02" for axis in (0, 1))),
    "stiff": finger(*(f"{JOINTS}[{axis}].spring_stiffness=1e3" for axis in (0, 1))),
    "free": finger(base="free"),
    "constrained": finger(base="constrained"),
    "bent": finger(
        "manipulators[0].initial_angles=0.301",
        *(f"{JOINTS}[{axis}].joint_neutral_position=0.3" for axis in (0, 1)),
    ),
    "beam": beam(10, 1e-3),
}


@pytest.mark.parametrize("name", CASES)
def test_the_explicit_limit_is_that_of_the_engine(name: str) -> None:
    """Within two percent on either side; nothing is wrong with a run well within."""
    scene = dataclasses.replace(CASES[name], integrator="explicit")
    if name == "beam":
        one = dataclasses.replace(scene.manipulators[0], initial_angles=(0.001,) * 10)
        scene = dataclasses.replace(scene, manipulators=(one,))
    limit = outlook(scene).explicit_step
    assert survives(scene, 0.98 * limit, 4000)
    assert not survives(scene, 1.02 * limit, 4000)


def test_a_thrown_body_has_no_stiffness_of_gravity() -> None:
    scene = scene_from_text(THROWN)
    still = dataclasses.replace(scene, gravity=(0.0, 0.0, 0.0))
    first, second = (outlook(one).modes["start"].squares for one in (scene, still))
    assert np.array_equal(first, second)


def test_the_worst_pose_met_counts() -> None:
    scene = scene_from_file("scene.yaml")
    plan = make_plan(scene)
    (body,) = plan.bodies
    alone = outlook_of(plan, body)
    start = np.zeros(10)
    bent = [(Pose(), start), (Pose(), start + 0.2), (Pose(), start + 0.4)]
    found = outlook_of(plan, body, bent)
    assert set(found.modes) == {"start", "neutral", "worst"}
    assert found.explicit_step == found.modes["worst"].explicit_step < alone.explicit_step
