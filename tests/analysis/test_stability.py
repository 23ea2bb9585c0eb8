"""Modes and the explicit limit: against closed forms, against oracles, and against runs."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from somo_cli.analysis.stability import StabilityForecast, forecast_of
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import SimulationDiverged
from somo_cli.scene.model import Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import largest_explicit_step
from somo_cli.simulation.plan.build import make_plan
from tests.builders.fingers import THROWN_FINGER
from tests.builders.pendulum import PENDULUM, PENDULUM_INERTIA
from tests.builders.runs import rows_of
from tests.builders.scenes import JOINTS, scene_from_file, scene_from_text

pytestmark = pytest.mark.slow

CUT = "manipulators[0].definition.actuator_definitions[0]"


def forecast(scene: Scene) -> StabilityForecast:
    plan = make_plan(scene)
    return forecast_of(plan, plan.bodies[0])


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
    [
        (3, 3.607808961845903, 77.69493129334919),
        (10, 3.524097960057064, 886.7879944021699),
        (40, 3.516519479232805, 14188.634213698897),
    ],
)
def test_a_chain_vibrates_as_computed(n: int, first: float, last: float) -> None:
    unit = math.sqrt(1 / 0.3)
    found = forecast(beam(n)).modes["start"].frequencies / unit
    assert found[0] == pytest.approx(first, rel=1e-8)
    assert found[-1] == pytest.approx(last, rel=1e-6)


def test_chains_near_the_beam_with_second_order() -> None:
    unit = math.sqrt(1 / 0.3)
    errors = []
    for n in (5, 10, 20, 40):
        first = forecast(beam(n)).modes["start"].frequencies[0] / unit
        errors.append(first / 3.51601526850015 - 1)
    # 9.3e-3, 2.3e-3, 5.7e-4, 1.4e-4
    assert errors == pytest.approx([9.3e-3, 2.3e-3, 5.7e-4, 1.4e-4], rel=0.05)
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2, abs=0.05)


def test_the_explicit_step_of_a_fine_chain_goes_with_the_square_of_its_joints() -> None:
    """0.2255 / n² sqrt(ρ A L⁴ / EI), without damping."""
    n = 40
    found = forecast(beam(n)).explicit_step
    assert found == pytest.approx(0.2255 / n**2 * math.sqrt(0.3), rel=0.01)


def test_one_hinge_has_its_frequency_and_its_ratio() -> None:
    scene = dataclasses.replace(scene_from_text(PENDULUM), gravity=(0.0, 0.0, 0.0))
    found = forecast(scene)
    omega = math.sqrt(50 / PENDULUM_INERTIA)
    zeta = 0.5 / (2 * math.sqrt(50 * PENDULUM_INERTIA))
    assert found.modes["start"].frequencies == pytest.approx([omega])
    assert found.modes["start"].damping_ratios == pytest.approx([zeta])
    # symplectic Euler: h ω = 2 (sqrt(1 + ζ²) - ζ)
    assert found.explicit_step * omega == pytest.approx(2 * (math.sqrt(1 + zeta**2) - zeta))


def test_gravity_stiffens_what_hangs_and_softens_what_stands() -> None:
    upright = scene_from_text(PENDULUM, f"{JOINTS.replace('manipulators[0].definition.', '')}[0]"
                              ".joint_neutral_position=0")  # fmt: skip
    hanging = dataclasses.replace(
        upright,
        manipulators=(dataclasses.replace(upright.manipulators[0], rpy=(math.pi, 0.0, 0.0)),),
    )
    weight = 1.0 * 9.81 * 0.5  # N·m/rad: 1 kg, its centre half a metre from the hinge
    for scene, sign in ((upright, -1), (hanging, 1)):
        modes = forecast(scene).modes["start"]
        assert modes.frequencies**2 == pytest.approx([(50 + sign * weight) / PENDULUM_INERTIA])
        assert not modes.topples
    soft = scene_from_text(PENDULUM.replace("spring_stiffness: 50", "spring_stiffness: 4"))
    assert forecast(soft).modes["start"].topples


# The transient chain: 1 m, 1 kg, EI = 4 N·m² in n joints, with 2 % of damping on its first mode.
@pytest.mark.parametrize(
    ("n", "first", "last"), [(5, 7.097095071538422, 442.6818858391887),
                             (20, 7.0360657469794035, 7094.317106831442)]
)  # fmt: skip
def test_damping_shortens_the_explicit_step_of_a_fine_chain(
    n: int, first: float, last: float
) -> None:
    """With damping in proportion to stiffness every mode is alone: ζ = 0.02 ω / ω₁."""
    factor = math.sqrt(1 / 0.3 / 4)  # the beam here has EI = 1 N·m² and 0.3 kg
    # d = τ k, k = n EI / L
    found = forecast(beam(n, 2 * 0.02 / (first * factor) * n))
    assert found.modes["start"].frequencies[[0, -1]] / factor == pytest.approx(
        [first, last], rel=1e-6
    )
    zeta = 0.02 * last / first
    limit = 2 * (math.sqrt(1 + zeta**2) - zeta) / (last * factor)
    assert found.explicit_step == pytest.approx(limit, rel=1e-6)


@pytest.mark.parametrize(
    ("zeta", "limit"),
    [(0, 2.0), (0.01, 1.9800999975001248), (0.1, 1.809975124224178), (0.5, 1.2360679774997898),
     (1, 0.8284271247461903), (5, 0.19803902718556898)],
)  # fmt: skip
def test_the_explicit_step_is_where_a_root_leaves_the_unit_circle(
    zeta: float, limit: float
) -> None:
    """h ω, against the eigenvalues of v' = v - h (ω² x + 2 ζ ω v), x' = x + h v'."""
    mass, stiffness = np.array([[0.7]]), np.array([50.0])
    omega = math.sqrt(50 / 0.7)
    step = largest_explicit_step(mass, stiffness, [2 * zeta * omega * 0.7])
    assert step * omega == pytest.approx(limit, rel=1e-12)

    def radius(h: float) -> float:
        v = [-h * omega**2, 1 - 2 * h * zeta * omega]
        return float(np.abs(np.linalg.eigvals([[1 + h * v[0], h * v[1]], v])).max())

    assert radius(0.999 * step) <= 1 + 1e-12 < radius(1.001 * step)


def test_damping_that_couples_modes_is_solved_for() -> None:
    """The roots satisfy det(s² M + s D + K) = 0; the diagonal alone would say otherwise."""
    scene = scene_from_file("finger.yaml")
    (finger,) = scene.manipulators
    joints = tuple(
        dataclasses.replace(joint, damping=joint.damping * (10 if number < 4 else 0.1))
        for number, joint in enumerate(finger.compiled.chain.joints)
    )
    chain = dataclasses.replace(finger.compiled.chain, joints=joints)
    compiled = dataclasses.replace(finger.compiled, chain=chain)
    uneven = dataclasses.replace(
        scene, manipulators=(dataclasses.replace(finger, compiled=compiled),)
    )
    for one in (scene, uneven):
        plan = make_plan(one)
        (body,) = plan.bodies
        pose = ChainDynamics(body.chain).at(body.start.angles)
        mass, k = pose.joint_inertia(), np.diag(pose.chain.stiffness)
        k = k + pose.gravity_stiffness(plan.gravity)
        d = np.diag(pose.chain.damping)
        modes = forecast(one).modes["start"]
        assert len(modes.all_roots) == 2 * len(mass)
        for root in modes.all_roots[[0, 5, 10, -1]]:
            values = np.linalg.svd(root**2 * mass + root * d + k, compute_uv=False)
            assert values[-1] < 1e-9 * values[0]
        # the sum of all roots is minus the trace of M⁻¹ D
        assert modes.all_roots.sum().real == pytest.approx(-np.trace(np.linalg.solve(mass, d)))
    assert modes.least_damping_ratio != pytest.approx(modes.damping_ratios.min(), rel=0.05)


def test_damping_in_proportion_to_stiffness_leaves_modes_alone() -> None:
    modes = forecast(beam(10, 1e-3)).modes["start"]
    assert modes.least_damping_ratio == pytest.approx(modes.damping_ratios[0], rel=1e-9)


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
    limit = forecast(scene).explicit_step
    assert survives(scene, 0.98 * limit, 4000)
    assert not survives(scene, 1.02 * limit, 4000)


def test_a_thrown_body_has_no_stiffness_of_gravity() -> None:
    scene = scene_from_text(THROWN_FINGER)
    still = dataclasses.replace(scene, gravity=(0.0, 0.0, 0.0))
    first, second = (forecast(one).modes["start"].squared_frequencies for one in (scene, still))
    assert np.array_equal(first, second)


def test_the_worst_visited_pose_counts() -> None:
    scene = scene_from_file("scene.yaml")
    plan = make_plan(scene)
    (body,) = plan.bodies
    alone = forecast_of(plan, body)
    start = np.zeros(10)
    bent = [(Pose(), start), (Pose(), start + 0.2), (Pose(), start + 0.4)]
    found = forecast_of(plan, body, bent)
    assert set(found.modes) == {"start", "neutral", "worst"}
    assert found.explicit_step == found.modes["worst"].explicit_step < alone.explicit_step
