"""Joints as moment arms: exact rules against the statics of the chain, and SoMo's formulas."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.calibration.moment_arms import (
    MomentArms,
    NoMomentArms,
    of_definition,
    of_joint_positions,
    of_uniform_actuator,
)
from somo_cli.manipulator.chain_build import build_chain
from somo_cli.manipulator.definition import Definition, Placement
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from tests.builders.definitions import Data, X, Y, Z, actuator, compiled, hinge, manipulator
from tests.builders.scenes import scene_from_file

XYZ = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
WANTED = 6.12  # N/m


def definition_of(*actuators: Data) -> Definition:
    return compiled(manipulator(*actuators)).definition


def compliance(definition: Definition, index: int, known: MomentArms) -> float:
    """Deflection of the point at `known.at` per force across it, by the Jacobian of the chain."""
    alone = build_chain(
        dataclasses.replace(
            definition, base=None, actuators=(definition.actuators[index],), tips=()
        )
    )
    body = ChainDynamics(alone)
    pose = body.at(np.zeros(body.count))
    link = int(np.sum(pose.origins[1:, 2] < known.at))
    point = np.array((0.0, 0.0, known.at))
    if known.kind == "torsion":
        force, moment = np.zeros(3), np.array((0.0, 0.0, 1.0))
    else:
        force, moment = np.cross(known.direction, (0.0, 0.0, 1.0)), np.zeros(3)
    torques = pose.generalised_force(link, point, force, moment)[6:]
    return float(torques @ (torques / body.stiffness))


ACTUATORS = {
    "planar": actuator(5, X),
    "two axes": actuator(10, X, Y),
    "odd": actuator(7, X, Y),
    "torsion": actuator(9, X, Y, Z),
    "gauss": actuator(10, X, Y, joint_placement="gauss"),
    "gauss torsion": actuator(9, X, Y, Z, joint_placement="gauss"),
    "offset": actuator(4, hinge(1, 0, 0, neutral_axis_offset=[0.001, 0.006, 0.002, 0, 0, 0])),
    "askew": actuator(6, hinge(3, 4, 0)),
    "profile": actuator(
        3, *(hinge(0, 1, 0, spring_stiffness=value) for value in (0.1, 0.2, 0.4)), planar_flag=2
    ),
}


@pytest.mark.parametrize("name", ACTUATORS)
@pytest.mark.parametrize("part", [1.0, 0.7])
def test_the_exact_rule_is_that_of_the_chain(name: str, part: float) -> None:
    definition = definition_of(actuator(2, X), ACTUATORS[name])
    one = definition.actuators[1]
    for axis in set(one.channels):
        at = None if part == 1 else part * 0.02 * one.n_segments
        known = of_definition(definition, 1, axis, at)
        own = one.joints[one.channels.index(axis)].stiffness
        expected = 1 / compliance(definition, 1, known)
        assert known.tip_stiffness(own) == pytest.approx(expected, rel=1e-12)
        assert known.stiffness(known.tip_stiffness(own)) == pytest.approx(own, rel=1e-12)


@pytest.mark.parametrize("placement", ["uniform", "gauss"])
@pytest.mark.parametrize("about", ["x", "z"])
def test_from_numbers_it_is_the_same_as_from_a_definition(placement: Placement, about: str) -> None:
    joint = hinge(*XYZ[about])
    definition = definition_of(actuator(8, Y, joint, joint_placement=placement))
    made = of_uniform_actuator(0.16, 4, 2, 1, XYZ[about], placement)
    known = of_definition(definition, 0, 1)
    assert made.places == pytest.approx(known.places)
    assert made.stiffness(WANTED) == pytest.approx(known.stiffness(WANTED))


def test_the_rule_in_numbers() -> None:
    # x_i = 5, 25, ... mm on 100 mm: 6.12 N/m times the sum of (L - x_i)²
    known = of_uniform_actuator(0.1, 5, 2, 0, XYZ["x"], "uniform")
    squares = 0.095**2 + 0.075**2 + 0.055**2 + 0.035**2 + 0.015**2
    assert known.stiffness(WANTED) == pytest.approx(6.12 * squares)
    assert known.torque(1.0) == pytest.approx(squares / (0.095 + 0.075 + 0.055 + 0.035 + 0.015))


def test_joints_may_be_anywhere() -> None:
    known = of_joint_positions(0.1, (0.085, 0.005, 0.025, 0.045, 0.065), XYZ["x"])
    assert known.stiffness(WANTED) == pytest.approx(0.117045)
    assert known.torque(0.75) == pytest.approx(0.0521590909)
    with pytest.raises(NoMomentArms, match=r"a joint at 0.1 m is not on the 0.1 m of actuator"):
        of_joint_positions(0.1, (0.05, 0.1), XYZ["x"])


def test_many_joints_are_a_beam() -> None:
    known = of_uniform_actuator(0.2, 1000, 1, 0, XYZ["x"], "uniform")
    assert known.stiffness(WANTED) == pytest.approx(1000 * known.rigidity(WANTED) / 0.2, rel=1e-6)
    assert known.rigidity(WANTED) == pytest.approx(WANTED * 0.2**3 / 3)
    assert known.torque(1.5 / 0.2) == pytest.approx(1.0, rel=1e-5)
    assert known.tip_stiffness_of_beam(known.rigidity(WANTED)) == pytest.approx(WANTED)


@pytest.mark.parametrize("count", [2, 3, 7])
def test_at_gauss_points_few_joints_are_a_beam(count: int) -> None:
    known = of_uniform_actuator(0.2, count, 1, 0, XYZ["x"], "gauss")
    assert known.stiffness(WANTED) == pytest.approx(count * known.rigidity(WANTED) / 0.2, rel=1e-12)
    assert known.torque(1.5 / 0.2) == pytest.approx(1.0, rel=1e-12)


def test_a_twisted_chain_has_equal_shares() -> None:
    known = of_uniform_actuator(0.2, 4, 1, 0, XYZ["z"], "uniform")
    assert known.stiffness(3.0) == pytest.approx(12)
    assert known.rigidity(3.0) == pytest.approx(0.6)  # GJ = K L
    assert known.torque(5.0) == pytest.approx(5)


@pytest.mark.parametrize(
    ("count", "off"),
    # numbers from the closed form (1 - 1/(3N)) (1 - 1/(4N²)) / 2 - 1 of one axis, N EI / L
    [(3, -0.5679), (5, -0.5380), (10, -0.5179), (20, -0.5086), (40, -0.5043)],
)
def test_somos_formula_is_twice_too_stiff(count: int, off: float) -> None:
    known = of_uniform_actuator(0.1, count, 1, 0, XYZ["x"], "uniform")
    made = known.tip_stiffness(known.somo_stiffness(WANTED))
    assert WANTED / made - 1 == pytest.approx(off, abs=1e-4)


def test_somos_torque_is_half_as_large_again() -> None:
    known = of_uniform_actuator(0.1, 40, 1, 0, XYZ["x"], "uniform")
    assert known.somo_torque(2.0) == 0.2
    assert known.somo_torque(2.0) / known.torque(2.0) == pytest.approx(1.5, rel=1e-3)


def test_the_shipped_finger() -> None:
    definition = scene_from_file("scene.yaml").manipulators[0].compiled.definition
    grasp, side = (of_definition(definition, 0, axis) for axis in (0, 1))
    # SoMo's own numbers: 87.43 and 414.9 units at a world scale of 20
    assert grasp.somo_stiffness(6.12) * 400 == pytest.approx(87.43, abs=0.01)
    assert side.somo_stiffness(29.05) * 400 == pytest.approx(415.0, abs=0.2)
    assert grasp.stiffness(6.12) == pytest.approx(0.117045)
    assert side.stiffness(29.05) == pytest.approx(0.41033125)
    for axis, known in enumerate((grasp, side)):
        own = definition.actuators[0].joints[axis].stiffness
        assert known.tip_stiffness(own) == pytest.approx((6.12, 29.05)[axis])


@pytest.mark.parametrize(
    ("data", "index", "axis", "message"),
    [
        (actuator(2, X), 1, 0, "there is no actuator 1, only 1 of them"),
        (actuator(2, X), 0, 1, "axis 1 of actuator 0 does not exist"),
        (actuator(2, X, {"joint_type": "fixed"}), 0, 1, "axis 1 of actuator 0 moves no joint"),
        (actuator(2, hinge(1, 0, 1)), 0, 0, "both bends and twists"),
        (actuator(2, X, hinge(1, 1, 0)), 0, 0, "are not at right angles"),
        (actuator(2, hinge(1, 0, 0, joint_neutral_position=0.1)), 0, 0, "not straight at rest"),
        (
            actuator(2, X, X | {"spring_stiffness": 0}, planar_flag=2),
            0,
            0,
            "some joints of the axis have a spring, and others have none",
        ),
    ],
)
def test_axes_without_moment_arms(data: Data, index: int, axis: int, message: str) -> None:
    with pytest.raises(NoMomentArms, match=message):
        of_definition(definition_of(data), index, axis)


@pytest.mark.parametrize(
    ("at", "message"),
    [
        (0.03, "is not a place on the 0.02 m"),
        (-1, "is not a place"),
        (0.004, "no joint of the axis"),
    ],
)
def test_where_a_force_cannot_act(at: float, message: str) -> None:
    with pytest.raises(NoMomentArms, match=message):
        of_uniform_actuator(0.02, 1, 1, 0, XYZ["x"], "uniform", at)
