"""Values and units of the columns of bodies; poses against PyBullet's own."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Dimension, Scale
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import columns
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.forward_kinematics import ForwardKinematics
from somo_cli.simulation.engine.bullet.world import BulletBody, BulletWorld
from somo_cli.simulation.engine.contacts import ContactPoint
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of
from somo_cli.simulation.recording.body_values import BODY_VALUES, BodyStates
from tests.builders.definitions import EVERYTHING, X, Y, actuator, bent, manipulator
from tests.builders.recorded_columns import COLUMN_NAMES, QUANTITIES, plan_that_records
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text


def state_in(plan: Plan, angles: list[float], base: Pose) -> BodyStates:
    """Return one and the same state, given in SI, in the units of the plan."""
    length = plan.scale.factor(Dimension(length=1))
    x, y, z = base.position
    moved = Pose((x * length, y * length, z * length), base.rotation)
    body = plan.bodies[0]
    by_channel = {(0, 0): 0.3, (0, 1): -0.2, (0, 2): 0.0, (1, 0): 0.7, (2, 0): -1.5}
    actuation = [by_channel[joint.actuator, joint.channel] for joint in body.chain.joints]
    rates = [0.5 * angle + 1 for angle in angles]
    return state_of(plan, angles, rates, actuation, moved)


def state_of(plan: Plan, angles: Any, rates: Any, actuation: Any, base: Pose) -> BodyStates:
    """Return a state whose base moves at 1 m/s along x and turns at 2 rad/s about z."""
    body, length = plan.bodies[0], plan.scale.factor(Dimension(length=1))
    velocity = (length, 0.0, 0.0), (0.0, 0.0, 2.0)
    dynamics = functools.partial(ChainDynamics, body.chain)
    force = plan.scale.factor(Dimension(mass=1, length=1, time=-2))
    rubs = ((1.0, 0.0, 0.0), force), ((0.0, 1.0, 0.0), -2 * force)
    touch = ContactPoint((0, 1), (1, 0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 3 * force, rubs)
    poses = ForwardKinematics(body.chain)
    angles, rates, actuation = (np.array(one)[:, np.newaxis] for one in (angles, rates, actuation))
    return BodyStates(
        body, angles, rates, actuation, [base], [velocity], plan.gravity, poses, dynamics,
        0, (1,), [[touch]],
    )  # fmt: skip


def row_of(plan: Plan, states: BodyStates) -> dict[str, float]:
    units = unit_factors_of(plan)
    return {
        name: value
        for group in columns.body_column_groups(plan.recorded)
        for name, value in zip(
            group.selection.names,
            BODY_VALUES[group.quantity](states, units)[:, 0].tolist(),
            strict=True,
        )
    }


TILTED = Pose((0.1, -0.2, 0.3), ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))


@pytest.mark.parametrize("scale", [Scale(20.0), Scale(8.0, 1000.0)])
def test_the_scale_is_never_seen(scale: Scale) -> None:
    rows = []
    for one in (Scale(), scale):
        world_scale = {"length": one.length, "mass": one.mass}
        plan = plan_that_records(EVERYTHING, *QUANTITIES, world_scale=world_scale)
        angles = bent(plan.bodies[0].chain)
        rows.append(row_of(plan, state_in(plan, angles, TILTED)))
    assert rows[1] == pytest.approx(rows[0], rel=1e-12, abs=1e-14)


def test_the_values_at_a_bent_pose() -> None:
    definition = manipulator(actuator(2, X, Y), actuator(1, {**X, "joint_neutral_position": 0.5}))
    plan = plan_that_records(definition, *QUANTITIES, world_scale=20)
    found = row_of(plan, state_in(plan, [0.3, -0.4, 0.1], TILTED))
    assert [found[f"a.{name}"] for name in COLUMN_NAMES["joint_angles"]] == [0.3, -0.4, 0.1]
    assert [found[f"a.{name}"] for name in COLUMN_NAMES["joint_rates"]] == [1.15, 0.8, 1.05]
    # stiffness 0.2 N·m/rad in every joint of tests/manipulator/bodies.py
    torques = [found[f"a.{name}"] for name in COLUMN_NAMES["spring_torques"]]
    assert torques == pytest.approx([-0.06, 0.08, 0.08])
    assert [found[f"a.{name}"] for name in COLUMN_NAMES["actuation"]] == pytest.approx(
        [0.3, -0.2, 0.7]
    )
    pose = [found[f"a.{name}"] for name in COLUMN_NAMES["base_pose"]]
    forces = [found[f"a.{name}"] for name in COLUMN_NAMES["contact_force"]]
    assert forces == pytest.approx([1, -2, 3, 3])
    half = math.sqrt(0.5)  # a quarter turn about z
    assert pose == pytest.approx([0.1, -0.2, 0.3, 0.0, 0.0, half, half])


def test_the_energies_of_a_pendulum() -> None:
    link = {"shape_type": "box", "dimensions": [0.1, 0.2, 2], "mass": 2.0}
    definition = manipulator(actuator(1, {**X, "joint_neutral_position": 0.5}, link=link))
    plan = plan_that_records(definition, "energy", world_scale=20)
    still = dataclasses.replace(
        state_in(plan, [0.3], Pose()),
        rates=np.array([[1.5]]),
        base_velocities=[((0.0,) * 3, (0.0,) * 3)],
    )
    found = row_of(plan, still)
    # the moving half of the link: 1 kg, 1 m long, 0.2 m wide, hinged at its end 1 m up
    inertia = (0.2**2 + 1) / 12 + 0.25
    assert found["a.energy.kinetic_j"] == pytest.approx(0.5 * inertia * 1.5**2)
    assert found["a.energy.elastic_j"] == pytest.approx(0.5 * 0.2 * 0.2**2)
    height = 0.5 + 1 + 0.5 * math.cos(0.3)  # of the two halves, 1 kg each
    assert found["a.energy.gravity_j"] == pytest.approx(9.81 * height)


def test_curvature_is_the_angle_over_the_backbone_it_stands_for() -> None:
    # one axis, half a metre in five segments; two axes that take turns, so 0.2 m for each joint
    link = {"shape_type": "box", "dimensions": [0.02, 0.02, 0.1], "mass": 0.1}
    for joints, radius_of_turn in (((X,), 0.1 / 0.05), ((X, Y), 0.2 / 0.05)):
        for scale in (1, 20):
            definition = manipulator(actuator(4, *joints, link=link))
            plan = plan_that_records(definition, "curvatures", world_scale=scale)
            found = row_of(plan, state_in(plan, [0.05] * 4, Pose()))
            assert list(found.values()) == pytest.approx([1 / radius_of_turn] * 4)


def test_orientations_are_unit_quaternions() -> None:
    plan = plan_that_records(EVERYTHING, "link_orientations", "base_pose")
    random = np.random.default_rng(3)
    count = len(plan.bodies[0].chain.joints)
    for _ in range(20):
        found = row_of(plan, state_in(plan, list(random.uniform(-3, 3, count)), TILTED))
        components = [value for name, value in found.items() if ".q" in name]
        lengths = np.linalg.norm(np.reshape(components, (-1, 4)), axis=1)
        assert np.allclose(lengths, 1.0, rtol=0, atol=1e-12)


@contextmanager
def at_a_bent_pose(scale: float) -> Iterator[tuple[Plan, BulletBody, list[float]]]:
    """Load a body whose base is moved and rotated and whose joints are bent; its poses in PyBullet.

    Yields the plan, the body and, of every link, root left out, position and rotation in SI.
    """
    plan = plan_that_records(
        EVERYTHING,
        "link_positions",
        "link_orientations",
        "tip_position",
        world_scale=scale,
        one={"position": [0.1, -0.2, 0.3], "rpy": [0.5, -0.7, 2.0], "base": "free"},
    )
    body = plan.bodies[0]
    start = dataclasses.replace(body.start, angles=tuple(bent(body.chain)))
    plan = dataclasses.replace(plan, bodies=(dataclasses.replace(body, start=start),))
    with BulletWorld(plan) as world:
        yield plan, world.bodies[0], list(start.angles)


@pytest.mark.parametrize("scale", [1.0, 20.0])
def test_poses_are_those_of_the_engine(scale: float) -> None:
    with at_a_bent_pose(scale) as (plan, loaded, angles):
        state = state_of(plan, angles, angles, angles, loaded.base_pose())
        found = row_of(plan, state)
        engine: Any = loaded
        bullet, index, client = engine.engine.module, loaded.index, engine.engine.number
        names = {
            bullet.getJointInfo(index, joint, client)[12].decode(): joint
            for joint in range(bullet.getNumJoints(index, client))
        }
        tip_in_world = None
        for link in plan.bodies[0].chain.links[1:]:
            reported = bullet.getLinkState(index, names[link.name], 0, 1, client)
            # the engine returns frames in single precision
            position = np.array(reported[4]) / scale
            ours = [found[f"a.{link.name}.{one}_m"] for one in "xyz"]
            assert ours == pytest.approx(position, abs=1e-6)
            turn = [found[f"a.{link.name}.{one}"] for one in ("qx", "qy", "qz", "qw")]
            assert abs(np.dot(turn, reported[5])) == pytest.approx(1.0, abs=1e-6)
            rotation = np.reshape(bullet.getMatrixFromQuaternion(reported[5]), (3, 3))
            tip_in_world = position + rotation @ np.array(plan.bodies[0].chain.tip) / scale
        assert [found[f"a.tip.{one}_m"] for one in "xyz"] == pytest.approx(tip_in_world, abs=1e-6)
        assert [found[f"a.base.{one}_m"] for one in "xyz"] == pytest.approx([0.1, -0.2, 0.3])


def test_actuation_is_recorded_as_the_scene_says_it_whatever_the_scale() -> None:
    """0.03 N·m times and over the factor of this scale is 0.030000000000000002."""
    scene = {
        "manipulators": [
            {
                "definition": "finger.yaml",
                "actuation": [{"actuator": 0, "axis": 0, "torque": 0.03}],
            }
        ],
        "world_scale": {"length": 3, "mass": 0.7},
        "record": {"columns": ["actuation"]},
    }
    rows = rows_of(scene_from_text(json.dumps(scene)), 3)
    assert {row[1] for row in rows} == {0.03}


@pytest.mark.parametrize("scale", [1, 20])
def test_the_velocity_of_a_tip_is_the_change_of_its_position(scale: float) -> None:
    plan = plan_that_records(EVERYTHING, "tip_position", "tip_velocity", world_scale=scale)
    angles = bent(plan.bodies[0].chain)
    states = state_in(plan, angles, TILTED)
    (base,), ((velocity, spin),) = states.base_poses, states.base_velocities
    centre = states.dynamics().at(states.angles[:, 0], base).centres[0]

    def positions(time: float) -> np.ndarray:
        turn = np.array(geometry.rotation_about((0.0, 0.0, 1.0), spin[2] * time))
        place = centre + time * np.array(velocity) + turn @ (np.array(base.position) - centre)
        moved = Pose(tuple(place), tuple(map(tuple, turn @ np.array(base.rotation))))
        later = dataclasses.replace(
            states, angles=states.angles + time * states.rates, base_poses=[moved]
        )
        return BODY_VALUES["tip_position"](later, unit_factors_of(plan))[:, 0]

    found = BODY_VALUES["tip_velocity"](states, unit_factors_of(plan))[:, 0]
    differences = (positions(1e-5) - positions(-1e-5)) / 2e-5
    assert found == pytest.approx(differences, rel=1e-7)
    assert np.linalg.norm(found) > 0.5


def test_bending_angles_and_orientation_of_a_circle() -> None:
    planar = manipulator(actuator(8, X), actuator(4, X))
    scene = {
        "gravity": [0, 0, 0],
        "manipulators": [{"name": "a", "definition": planar, "initial_angles": 0.1}],
        "record": {"columns": ["bending_angles", "tip_orientation", "joint_angles"]},
    }
    plan = make_plan(scene_from_text(json.dumps(scene)))
    names = columns.header(plan.recorded)
    start = dict(zip(names, rows_of(plan, 1)[0], strict=True))
    assert start["a.actuator_0_axis_0.bend_rad"] == pytest.approx(0.8)
    assert start["a.actuator_1_axis_0.bend_rad"] == pytest.approx(0.4)
    assert start["a.tip_orientation.qx"] == pytest.approx(math.sin(0.6))
    assert start["a.tip_orientation.qw"] == pytest.approx(math.cos(0.6))


def test_the_tip_of_a_free_body_moves_with_its_base_whatever_else_is_recorded() -> None:
    """The velocity of the base was once read only where the energy is recorded as well."""
    scene = {
        "gravity": [0, 0, 0],
        "time_step": 1e-5,
        "manipulators": [
            {
                "name": "a",
                "definition": manipulator(actuator(2, X)),
                "base": "free",
                "linear_velocity": [0.1, 0.2, -0.3],
            }
        ],
        "record": {"columns": ["tip_velocity"]},
    }
    plan = make_plan(scene_from_text(json.dumps(scene)))
    assert rows_of(plan, 1)[0][1:] == pytest.approx([0.1, 0.2, -0.3], abs=1e-9)
