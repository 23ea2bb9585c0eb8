"""What is divergence and what is not: no false alarm, no late one, and advice that holds."""

from __future__ import annotations

import dataclasses
import json
import math
import re
from collections.abc import Sequence

import numpy as np
import pytest

from somo_cli.problems import SimulationDiverged
from somo_cli.simulation import run
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import natural_frequencies
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.integrator.energy_bound import SMALL_ANGLE, BodyEnergy
from somo_cli.simulation.monitoring import divergence
from somo_cli.simulation.monitoring.divergence import DivergenceMonitor, StateHistory
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.joint_springs import JointSprings
from somo_cli.simulation.plan.model import Plan
from tests.builders import pendulum
from tests.builders.definitions import actuator, hinge, manipulator
from tests.builders.fake_world import (
    HINGE_INERTIA,
    HINGE_NEUTRAL,
    HINGE_STIFFNESS,
    energy_of_hinge,
    plan_of_hinges,
)
from tests.builders.runs import rows_of, simulated
from tests.builders.scenes import DEFINITIONS, scene_from_file, scene_from_text

SCENES = sorted(path.name for path in DEFINITIONS.glob("*scene.yaml"))
JOINTS = "manipulators[0].definition.actuator_definitions[0].joint_definitions"


@pytest.fixture
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Halve the bound of the divergence monitor: ordinary motion is far from an alarm."""
    monkeypatch.setattr(divergence, "MAX_ENERGY_RATIO", divergence.MAX_ENERGY_RATIO / 2)


@pytest.mark.moderate
@pytest.mark.usefixtures("narrow")
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
@pytest.mark.parametrize("name", SCENES)
def test_no_alarm_in_the_scenes_we_ship(name: str, integrator: str) -> None:
    scene = scene_from_file(name, f"integrator={integrator}", "record.every=100")
    simulated(scene, 1200)


@pytest.mark.moderate
@pytest.mark.usefixtures("narrow")
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
@pytest.mark.parametrize("time_step", [1e-3, 4e-3])
@pytest.mark.parametrize(
    "start",
    [
        "{base: free}",
        "{base: free, initial_angles: 0.2, initial_rates: 3}",
        "{base: free, linear_velocity: [2, 0, 5], angular_velocity: [3, -10, 4]}",
        "{base: constrained, rpy: [1.5707963, 0, 0]}",
        "{rpy: [1.5707963, 0, 0]}",
        "{rpy: [0, 1.5707963, 0], initial_angles: 0.3}",
        "{rpy: [3.14159265, 0, 0], initial_rates: 20}",
        "{initial_angles: 0.6}",
    ],
)
def test_no_alarm_when_a_finger_falls_or_is_let_go(
    start: str, time_step: float, integrator: str
) -> None:
    text = (
        f"time_step: {time_step}\nintegrator: {integrator}\n"
        f"manipulators:\n  - <<: {start}\n    definition: finger.yaml\n"
    )
    simulated(scene_from_text(text, "record={every: 100, columns: [joint_angles]}"), 500)


@pytest.mark.usefixtures("narrow")
def test_no_alarm_for_an_undamped_finger() -> None:
    undamped = [f"{JOINTS}[{axis}].spring_damping=0" for axis in (0, 1)]
    simulated(scene_from_file("scene.yaml", *undamped, "manipulators[0].initial_angles=0.1"), 3000)


@pytest.mark.moderate
@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_no_alarm_in_free_fall(integrator: str) -> None:
    """Three seconds, 44 m: the base's energy is many times what the springs can hold."""
    scene = scene_from_text(
        "manipulators:\n"
        "  - {definition: snake.yaml, base: free, initial_angles: 0.2,\n"
        "     angular_velocity: [1, 2, 3]}\n"
    )
    step = 1e-3 if integrator != "explicit" else 1e-4
    scene = dataclasses.replace(
        scene, integrator=integrator, time_step=step, every=1000, columns=("base_pose",)
    )
    rows = rows_of(scene, round(3 / step))
    # the frame's origin is off the centre of mass, about which the snake spins
    assert rows[-1][3] - rows[0][3] == pytest.approx(-9.81 * 9 / 2, abs=2)


@pytest.mark.parametrize("name", ["scene.yaml", "arm_scene.yaml", "snake_scene.yaml"])
def test_no_alarm_in_the_shipped_scenes_at_large_steps(name: str) -> None:
    scene = dataclasses.replace(scene_from_file(name), time_step=5e-3, every=100)
    assert rows_of(scene, 400)


def diverged(plan: Plan, steps: int) -> tuple[SimulationDiverged, list[list[float]]]:
    rows: list[list[float]] = []
    with BulletWorld(plan) as world, pytest.raises(SimulationDiverged) as caught:
        run.run(plan, world, lambda block: rows.extend(block.tolist()), steps, lambda: 0.0)
    return caught.value, rows


def explicit(time_step: float, every: int = 1, *sets: str) -> Plan:
    """Return the planar finger, whose joints differ 16 times in stiffness, slightly bent."""
    scene = scene_from_file(
        "planar_finger_scene.yaml",
        "integrator=explicit",
        f"time_step={time_step!r}",
        f"record={{every: {every}, columns: [joint_angles, joint_rates]}}",
        "manipulators[0].initial_angles=0.02",
        "manipulators[0].actuation=[]",
        "gravity=[0, 0, 0]",
        *sets,
    )
    return make_plan(scene)


def advised(error: SimulationDiverged) -> float:
    match = re.search(r"stable below a step of ([0-9.e+-]+) s", error.hint)
    assert match, error.hint
    return float(match[1])


@pytest.fixture(scope="module")
def largest() -> float:
    return advised(diverged(explicit(1e-3), 100)[0])


def with_damping(damping: float) -> list[str]:
    """Return the overrides that give all five joints of the planar finger one damping."""
    return [f"{JOINTS}[{joint}].spring_damping={damping}" for joint in range(5)]


@pytest.mark.parametrize("sets", [[], with_damping(0.0), with_damping(1e-4)])
def test_the_step_of_the_advice_is_stable_and_more_is_not(sets: list[str]) -> None:
    largest = advised(diverged(explicit(1e-3, 1, *sets), 100)[0])
    assert 1e-5 < largest < 1e-3
    simulated(explicit(0.98 * largest, 100, *sets), 4000)
    diverged(explicit(1.1 * largest, 100, *sets), 4000)


def test_without_damping_the_advice_is_two_over_the_highest_frequency() -> None:
    plan = explicit(1e-3, 1, *with_damping(0.0))
    chain = ChainDynamics(plan.bodies[0].chain)
    assert not chain.damping.any()
    mass = chain.at(np.full(5, 0.02)).joint_inertia()
    highest = natural_frequencies(mass, chain.stiffness)[-1]  # rad/s
    # the advice has three digits
    assert advised(diverged(plan, 100)[0]) == pytest.approx(2 / highest, rel=5e-3)


@pytest.mark.parametrize("every", [1, 1000])
@pytest.mark.parametrize("factor", [1.02, 1.1, 2.0, 10.0, 1e3])
def test_divergence_is_reported_while_angles_are_below_a_turn(
    largest: float, factor: float, every: int
) -> None:
    plan = explicit(factor * largest, every)
    error, rows = diverged(plan, 20_000)
    assert np.isfinite(rows).all()
    assert np.abs(np.array(rows)[:, 1:6]).max() < 2 * math.pi
    assert error.time == pytest.approx(error.step * plan.time_step)
    assert re.fullmatch(r"planar_finger\.actuator_0_joint_0[1-5]", error.name)


@pytest.mark.parametrize("factor", [1.1, 2.0, 1e2])
def test_divergence_is_reported_within_few_steps_of_the_growth(
    largest: float, factor: float
) -> None:
    """Energy, worked out from the rows, is nowhere beyond the bound; soon after, it would be."""
    plan = explicit(factor * largest)
    error, rows = diverged(plan, 20_000)
    assert len(rows) == error.step
    with BulletWorld(plan) as world:
        springs = np.array([joint.stiffness for joint in plan.bodies[0].chain.joints])
        energies = []
        for row in np.array(rows):
            angles, rates = row[1:6], row[6:11]
            mass = world.bodies[0].mass_matrix(angles.tolist())
            energies.append(rates @ mass @ rates / 2 + springs @ angles**2 / 2)
    assert max(energies) < 1.5 * divergence.MAX_ENERGY_RATIO_EXPLICIT * energies[0]


def test_the_energy_of_a_stable_explicit_run_near_its_limit_is_no_divergence() -> None:
    """A mode at 0.95 of its limit has up to (1 + x) / (1 - x) = 39 times its energy in turn."""
    # 4 I - 2 h d - h² k = 0 of the hinge of the tests of physics
    largest = (-0.5 + math.sqrt(0.25 + 4 * pendulum.PENDULUM_INERTIA * 50)) / 50
    simulated(make_plan(pendulum.pendulum_scene("explicit", 0.95 * largest)), 2000)
    diverged(make_plan(pendulum.pendulum_scene("explicit", 1.02 * largest)), 2000)


def test_the_joint_that_diverges_is_named() -> None:
    joints = [hinge(1, 0, 0, spring_stiffness=k) for k in (0.2, 0.2, 900.0, 0.2)]
    body = manipulator(actuator(4, *joints, planar_flag=2))
    soft = manipulator(actuator(2, hinge(1, 0, 0, spring_stiffness=1e-3)))
    scene = {
        "integrator": "explicit",
        "manipulators": [
            {"name": "calm", "definition": soft, "initial_angles": 0.1},
            {"name": "wild", "definition": body, "position": [1, 0, 0], "initial_angles": 0.01},
        ],
    }
    error, _ = diverged(make_plan(scene_from_text(json.dumps(scene), "time_step=0.0003")), 500)
    assert error.name == "wild.actuator_0_joint_03"


def test_the_advice_for_the_other_integrators() -> None:
    def hint(integrator: str) -> str:
        plan = dataclasses.replace(plan_of_hinges(time_step=0.5), integrator=integrator)
        with pytest.raises(SimulationDiverged) as caught:
            divergence.check(3, plan, [moving(plan, [1e3])])
        assert caught.value.reason == "it turns 500 rad in one step"
        assert (caught.value.step, caught.value.time) == (3, 1.5)
        return caught.value.hint

    assert hint("implicit") == "try half the step, --time-step 0.25, or integrator: euler"
    assert hint("euler") == "try half the step, --time-step 0.25"


@dataclasses.dataclass
class BodyInMotion:
    body: divergence.Body
    energy: BodyEnergy
    max_rate: float
    mass: np.ndarray
    mass_at_start: np.ndarray
    rates: np.ndarray

    def measure(self) -> None:
        """Be as it is."""


def moving(plan: Plan, rates: Sequence[float], index: int = 0) -> BodyInMotion:
    """Return a body of hinges at rest at its neutral angles, which then has these rates."""
    body = plan.bodies[index]
    ones = np.ones(len(rates))
    springs = JointSprings(HINGE_STIFFNESS * ones, 0.0 * ones, HINGE_NEUTRAL * ones)
    energy = BodyEnergy(body, springs, (0.0, 0.0, 0.0))
    mass = HINGE_INERTIA * np.diag(ones)
    for present in (0.0 * ones, np.array(rates)):
        energy.update(HINGE_NEUTRAL * ones, present, mass)
    max_rate = float(np.abs(rates).max()) if np.isfinite(rates).all() else math.nan
    return BodyInMotion(body, energy, max_rate, mass, mass, np.array(rates))


def test_what_is_not_a_number_is_noticed_and_named() -> None:
    plan = plan_of_hinges(3, names=("a", "b"))
    still, lost = moving(plan, [0.0] * 3), moving(plan, [0.0, math.nan, 1.0], 1)
    divergence.check(0, plan, [still, still])
    with pytest.raises(SimulationDiverged) as caught:
        divergence.check(7, plan, [still, lost])
    assert caught.value.name == "b.actuator_0_joint_02"


def test_energy_of_one_body_may_come_from_another() -> None:
    plan = plan_of_hinges(1, names=("a", "b"))
    first, struck = moving(plan, [0.0]), moving(plan, [1.0], 1)
    with pytest.raises(SimulationDiverged):
        divergence.check(1, plan, [first, struck])
    # the first one had been bent, and gave what it had
    first.energy = energy_of_hinge()
    for angle in (0.3, HINGE_NEUTRAL):
        first.energy.update(np.array([angle]), np.zeros(1), HINGE_INERTIA * np.eye(1))
    divergence.check(1, plan, [first, struck])


def test_small_motion_is_never_reported_as_divergence() -> None:
    plan = plan_of_hinges(1)
    one = moving(plan, [0.0])
    angles = np.array([HINGE_NEUTRAL + 0.5 * SMALL_ANGLE])
    one.energy.update(angles, np.zeros(1), HINGE_INERTIA * np.eye(1))
    divergence.check(1, plan, [one])


PULSE = "interpolation: step, waypoints: [[0, 0], [{}, {}], [{}, 0]]"


@pytest.mark.moderate
@pytest.mark.parametrize("every", [1, 1000])
@pytest.mark.parametrize("start", [0.0, 0.0005, 0.0015, 0.0025, 0.0065])
@pytest.mark.parametrize(
    "pulse",
    [
        "actuation=[{{actuator: 0, axis: 0, {}}}]",
        "loads=[{{link: tip, force: [0.3, 0, 0], {}}}]",
    ],
)
def test_the_work_of_a_pulse_between_two_checks_is_counted(
    pulse: str, start: float, every: int
) -> None:
    factor = 0.3 if "actuation" in pulse else 1.0
    course = PULSE.format(start + 1e-4, factor, start + 0.0051)
    for base in ("static", "free"):
        body = f"{{definition: finger.yaml, base: {base}}}"
        scene = scene_from_text(
            f"gravity: [0, 0, 0]\nmanipulators: [{body}]\n",
            f"record={{every: {every}, columns: [joint_angles]}}",
            "manipulators[0]." + pulse.format(course),
        )
        rows, _ = simulated(scene, 1000)
        assert max(map(abs, rows[-1])) > 1e-3


def test_work_that_is_not_counted_would_be_reported_as_divergence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(BodyEnergy, "add_work", lambda energy, work: None)
    with pytest.raises(SimulationDiverged):
        test_the_work_of_a_pulse_between_two_checks_is_counted(
            "actuation=[{{actuator: 0, axis: 0, {}}}]", 0.0005, 1
        )


def history_of(angles: list[float], rates: list[float]) -> StateHistory:
    mass = HINGE_INERTIA * np.eye(1)
    return StateHistory(np.array([angles]).T, np.array([rates]).T, [mass] * len(angles))


def test_rows_before_the_first_that_is_refused_are_sound() -> None:
    plan = plan_of_hinges(1, names=("a", "b"))
    bodies = [moving(plan, [1.0], index) for index in range(2)]
    for body in bodies:
        body.energy.add_work(1.0)
    monitor = DivergenceMonitor(plan, bodies)
    calm = history_of([HINGE_NEUTRAL] * 5, [0.1] * 5)
    assert monitor.count_valid_rows(5, [calm, calm]) == 5
    for wild in (1e6, -1e6, 1e3, math.nan, math.inf):
        swift = history_of([HINGE_NEUTRAL] * 5, [0.1, 0.1, wild, 0.1, wild])
        assert (
            monitor.count_valid_rows(5, [calm, swift])
            == monitor.count_valid_rows(5, [swift, calm])
            == 2
        )
        with pytest.raises(SimulationDiverged) as caught:
            monitor.raise_diverged(7, [calm, swift], 2)
        assert (caught.value.step, caught.value.name) == (7, "b.actuator_0_joint_01")
    bent = history_of([HINGE_NEUTRAL, 4.0], [0.0, 0.0])  # fast enough, but more than was put in
    assert monitor.count_valid_rows(5, [calm, history_of([HINGE_NEUTRAL] * 5, [0.1] * 5)]) == 5
    assert monitor.count_valid_rows(2, [bent, history_of([HINGE_NEUTRAL] * 2, [0.0] * 2)]) == 1
    assert monitor.count_valid_rows(0, [history_of([], []), history_of([], [])]) == 0


def test_scenes_are_found() -> None:
    assert len(SCENES) >= 5
