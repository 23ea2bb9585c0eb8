"""Joint limits within the law: the least torques that hold, and bodies that stay within."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.simulation.integrator.joint_limits import JointLimits, limit_torques
from tests.builders.definitions import EVERYTHING, chain_of
from tests.builders.runs import rows_of
from tests.builders.scenes import JOINTS, scene_from_text


@pytest.mark.parametrize("seed", range(30))
def test_least_torques_solve_the_complementarity_problem(seed: int) -> None:
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 12))
    root = random.normal(size=(n, n))
    response = root @ root.T + 1e-3 * np.eye(n)
    lowest, highest = -random.uniform(0, 1, n), random.uniform(0, 1, n)
    acceleration = 3 * random.normal(size=n)
    torques = limit_torques(acceleration, response, lowest, highest)
    reached = acceleration + response @ torques
    assert (reached < highest + 1e-9).all()
    assert (reached > lowest - 1e-9).all()
    assert reached[torques < 0] == pytest.approx(highest[torques < 0], abs=1e-9)
    assert reached[torques > 0] == pytest.approx(lowest[torques > 0], abs=1e-9)


def stops(*limits: tuple[float, float]) -> JointLimits:
    """Return the stops of so many joints; lower beyond upper means none, as in a chain."""
    joint = chain_of(EVERYTHING).joints[0]
    return JointLimits([dataclasses.replace(joint, lower=a, upper=b) for a, b in limits])


def test_room_is_to_the_nearest_limit() -> None:
    some = stops((-0.5, 1.0), (1.0, -1.0), (-2.0, 0.7))
    assert some.clearance(np.array([0.0, 9.0, 0.0])) == pytest.approx(0.5)
    assert some.clearance(np.array([0.0, 9.0, 0.4])) == pytest.approx(0.3)
    assert stops((1.0, -1.0)).clearance(np.array([9.0])) == np.inf


def test_a_joint_that_contact_drove_beyond_its_limit_has_struck_it() -> None:
    some = stops((-0.5, 0.5))
    some.clearance(np.array([0.49]))
    assert not some.were_struck
    some.clearance(np.array([0.501]))  # no torque was asked for on the way there
    assert some.were_struck


def test_a_joint_beyond_its_limit_comes_back_by_a_fifth_in_each_step() -> None:
    angles, rates, response = np.array([0.6]), np.array([0.0]), np.array([[2.0]])
    torques = stops((-0.5, 0.5)).torques(0.1, angles, rates, np.array([0.0]), response)
    assert torques is not None
    turn = 0.1 * (rates + 0.1 * (response @ torques))
    assert turn == pytest.approx(-0.02)


def test_joints_within_their_limits_are_left_alone() -> None:
    still = np.zeros(2)
    some = stops((-0.5, 0.5), (1.0, -1.0))
    assert some.torques(1e-3, still, np.array([9.0, 1e9]), still, np.eye(2)) is None


STRUCK = (
    "manipulators:\n"
    "  - definition: finger.yaml\n"
    "    actuation:\n"
    "      - {actuator: 0, axis: 0, torque: 0.2}\n"
    "      - {actuator: 0, axis: 1, torque: 0.4}\n"
    "record: {every: 1, columns: [joint_angles]}\n"
)


@pytest.mark.moderate
@pytest.mark.parametrize("base", ["static", "free"])
@pytest.mark.parametrize("integrator", ["implicit", "euler"])
@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_joints_pressed_on_their_limits_rest_there(base: str, integrator: str, step: float) -> None:
    """Torques beyond what the springs hold at 0.3 rad, stepped in, on all joints together."""
    scene = scene_from_text(
        STRUCK,
        f"manipulators[0].base={base}",
        "gravity=[0, 0, 0]",
        *(f"{JOINTS}[{axis}].limits=[-0.3, 0.3, 0.25, 3]" for axis in (0, 1)),
        *(f"{JOINTS}[{axis}].spring_damping=0.005" for axis in (0, 1)),
    )
    scene = dataclasses.replace(scene, time_step=step, integrator=integrator)
    angles = np.array(rows_of(scene, round(2 / step)))[:, 1:]
    assert angles.max() < 0.3 + 2e-3
    # a free base that the impacts have set turning makes its joints tremble a little
    assert angles[-1] == pytest.approx(0.3, abs=1e-6 if base == "static" else 1e-3)
