"""The engine does what we think it does: poses, inertias, forces, constraints, and no noise."""

from __future__ import annotations

import dataclasses
import json
import locale
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineMissing, EngineRefused
from somo_cli.simulation.engine.bullet import collision_filter
from somo_cli.simulation.engine.bullet.body import MAX_UNNAMED_JOINTS, ZERO_EFFECT_TORQUE
from somo_cli.simulation.engine.bullet.world import BulletBody, BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.builders.definitions import EVERYTHING, X, Y, actuator, bent, hinge, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text

STEP = 1e-3  # s
# a base whose mass is off its frame's origin, with principal axes askew
ASKEW = {
    **EVERYTHING,
    "base_definition": {
        "shape_type": "box",
        "dimensions": [0.02, 0.04, 0.06],
        "mass": 0.3,
        "origin_offset": [0.01, -0.02, 0.03, 0.3, 0.5, -0.7],
    },
}
PLACED = {"position": [0.1, -0.2, 0.3], "rpy": [0.4, -0.5, 0.6]}


def plan_of_manipulators(*manipulators: dict[str, Any], **more: Any) -> Plan:
    data = {"gravity": [0, 0, 0], "time_step": STEP, **more}
    return make_plan(scene_from_text(json.dumps({**data, "manipulators": manipulators})))


def askew(base: str, **more: Any) -> Plan:
    return plan_of_manipulators({"definition": ASKEW, "base": base, **PLACED, **more})


def rates_of(body: BulletBody) -> np.ndarray:
    return np.array([state[1] for state in body.joint_states()])


# loading


def test_two_worlds_do_not_disturb_each_other() -> None:
    plans = [
        plan_of_manipulators({"definition": EVERYTHING}, gravity=[0, 1, -9.81]),
        plan_of_manipulators(
            {"definition": "finger.yaml", "rpy": [1, 0, 0]}, gravity=[3, 0, 0], time_step=2e-3
        ),
    ]

    def alone(plan: Plan) -> list[Any]:
        with BulletWorld(plan) as world:
            for _ in range(20):
                world.step()
            return list(world.bodies[0].joint_states())

    with BulletWorld(plans[0]) as one, BulletWorld(plans[1]) as two:
        for _ in range(20):
            two.step()
            one.step()
        together = [list(world.bodies[0].joint_states()) for world in (one, two)]
    assert together == [alone(plan) for plan in plans]


def test_worlds_of_the_same_names_are_not_mistaken() -> None:
    """The engine has a cache of files by their names."""
    for mass in (0.5, 0.25):
        tip = {"shape_type": "sphere", "dimensions": [0.01], "mass": mass}
        plan = plan_of_manipulators({"definition": manipulator(actuator(1, X), tip_definition=tip)})
        with BulletWorld(plan) as world:
            engine: Any = world.bodies[0]
            reported = engine.engine.getDynamicsInfo(engine.index, 0)
            assert reported[0] == pytest.approx(mass + 0.0015)


def test_the_world_is_left_also_after_an_error() -> None:
    world = BulletWorld(askew("static"))

    def fail() -> None:
        with world:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    engine: Any = world.bodies[0]
    assert engine.engine.number == -1
    world.close()


def test_a_world_is_entered_before_it_is_stepped() -> None:
    with pytest.raises(RuntimeError):
        BulletWorld(askew("static")).step()


def test_a_missing_engine_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    with pytest.raises(EngineMissing, match=r"PyBullet, is not installed"):
        BulletWorld(askew("static")).__enter__()


@pytest.fixture
def comma(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let C write decimal commas; makes a locale that does if the machine has none."""
    before = locale.setlocale(locale.LC_NUMERIC)
    names = ["de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "German_Germany.1252", "made"]
    try:
        for name in names:
            if name == "made":
                _make_locale(tmp_path / name)
                monkeypatch.setenv("LOCPATH", str(tmp_path))
            try:
                locale.setlocale(locale.LC_NUMERIC, name)
            except locale.Error:
                continue
            if locale.localeconv()["decimal_point"] == ",":
                yield
                return
        pytest.skip("no locale with a decimal comma")
    finally:
        locale.setlocale(locale.LC_NUMERIC, before)


def _make_locale(path: Path) -> None:
    compiler = shutil.which("localedef")
    if compiler:
        command = [compiler, "-i", "de_DE", "-f", "UTF-8", "--no-archive", str(path)]
        subprocess.run(command, capture_output=True, check=False)


@pytest.mark.moderate
@pytest.mark.usefixtures("comma")
def test_a_decimal_comma_changes_nothing() -> None:
    own = locale.setlocale(locale.LC_NUMERIC)
    scene = scene_from_file("scene.yaml")
    with_comma = rows_of(scene, 20)
    assert locale.setlocale(locale.LC_NUMERIC) == own
    locale.setlocale(locale.LC_NUMERIC, "C")
    assert rows_of(scene, 20) == with_comma


@pytest.mark.parametrize("text", ["<robot", "<robot name='a'/>", "nothing"])
def test_the_message_of_the_engine_on_an_unreadable_file_is_reported(
    text: str, capfd: pytest.CaptureFixture[str]
) -> None:
    plan = askew("static")
    plan = dataclasses.replace(plan, bodies=(dataclasses.replace(plan.bodies[0], urdf=text),))
    with pytest.raises(EngineRefused) as caught:
        BulletWorld(plan).__enter__()
    assert caught.value.body == "body"
    assert caught.value.reason
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("moments", [[1e-5, 0, 0, 1e-5, 0, -1e-6], [1e-5, 0, 0, 1e-5, 0, 3e-5]])
def test_an_impossible_inertia_is_refused(moments: list[float]) -> None:
    """The engine would go on with one of its own, without a word to the program."""
    link = {
        "shape_type": "box", "dimensions": [0.02, 0.02, 0.1], "mass": 0.01,
        "inertial_values": moments,
    }  # fmt: skip
    plan = plan_of_manipulators({"definition": manipulator(actuator(2, X, link=link))})
    with pytest.raises(EngineRefused, match="inertia of actuator_0_segment_01 is"):
        BulletWorld(plan).__enter__()


def test_missing_joints_are_reported() -> None:
    plan = askew("static")
    body = dataclasses.replace(plan.bodies[0], urdf=plan.bodies[0].urdf.replace("_joint_02", "_x"))
    with pytest.raises(EngineRefused, match=r"missing \['actuator_0_joint_02'"):
        BulletWorld(dataclasses.replace(plan, bodies=(body,))).__enter__()


# the base


@pytest.mark.parametrize("base", ["static", "free", "constrained"])
def test_the_base_stands_where_the_scene_says(base: str) -> None:
    plan = askew(base)
    start = plan.bodies[0].start
    with BulletWorld(plan) as world:
        pose = world.bodies[0].base_pose()
    assert pose.position == pytest.approx(start.position, abs=1e-14)
    expected = geometry.rotation_from_rpy(start.rpy)
    assert np.allclose(pose.rotation, expected, rtol=0, atol=1e-14)


def test_the_base_moves_as_the_scene_says() -> None:
    linear, angular = [0.3, -0.4, 0.5], [2.0, -3.0, 1.0]
    plan = askew("free", linear_velocity=linear, angular_velocity=angular)
    rotation = np.array(geometry.rotation_from_rpy(plan.bodies[0].start.rpy))
    arm = rotation @ np.array(plan.bodies[0].chain.links[0].inertial.centre)
    with BulletWorld(plan) as world:
        velocity, spin = world.bodies[0].base_velocity()
    assert spin == pytest.approx(angular, abs=1e-14)
    assert velocity == pytest.approx(np.array(linear) + np.cross(angular, arm), abs=1e-14)


def test_the_origin_of_the_base_frame_has_the_velocity_of_the_scene() -> None:
    """By finite differences of what the engine does, to the first order of the step."""
    linear, angular = [0.3, -0.4, 0.5], [2.0, -3.0, 1.0]
    errors = []
    for step in (1e-3, 1e-4):
        one = {"definition": ASKEW, "base": "free", **PLACED}
        moving = {"linear_velocity": linear, "angular_velocity": angular}
        plan = plan_of_manipulators({**one, **moving}, time_step=step)
        with BulletWorld(plan) as world:
            before = world.bodies[0].base_pose()
            world.step()
            after = world.bodies[0].base_pose()
        moved = np.subtract(after.position, before.position) / step
        turned = (np.array(after.rotation) @ np.array(before.rotation).T - np.eye(3)) / step
        spin = [turned[2, 1], turned[0, 2], turned[1, 0]]
        errors.append([np.abs(moved - linear).max(), np.abs(np.subtract(spin, angular)).max()])
    assert np.all(np.array(errors[0]) < 0.05)
    assert np.all(np.array(errors[1]) < 0.15 * np.array(errors[0]))


def test_reset_brings_everything_back_exactly() -> None:
    angular = [2.0, -3.0, 1.0]
    plan = askew("free", initial_angles=0.1, initial_rates=-0.5, angular_velocity=angular)
    with BulletWorld(plan) as world:
        body = world.bodies[0]

        def state() -> tuple[Pose, Any, list[tuple[float, float]]]:
            pairs = [(state[0], state[1]) for state in body.joint_states()]
            return body.base_pose(), body.base_velocity(), pairs

        before = state()
        assert before[2] == [(0.1, -0.5)] * len(plan.bodies[0].chain.joints)
        for _ in range(30):
            world.step()
        assert state() != before
        body.reset(plan.bodies[0].start.angles, plan.bodies[0].start.rates)
        assert state() == before
        given = ((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
        body.reset(plan.bodies[0].start.angles, plan.bodies[0].start.rates, given)
        assert body.base_velocity() == given


# forces


@pytest.mark.parametrize("segments", [1, MAX_UNNAMED_JOINTS // 2, MAX_UNNAMED_JOINTS // 2 + 1])
def test_torques_are_all_that_is_applied_however_many_joints(segments: int) -> None:
    plan = plan_of_manipulators({"definition": manipulator(actuator(segments, X, Y))})
    count = len(plan.bodies[0].chain.joints)
    torques = np.random.default_rng(segments).normal(size=count).tolist()
    rates = []
    for is_by_name in (False, True):
        with BulletWorld(plan) as world:
            body, engine = world.bodies[0], world.engine
            joints, mode = list(range(count)), engine.TORQUE_CONTROL
            for _ in range(3):
                if is_by_name:
                    engine.setJointMotorControlArray(body.index, joints, mode, forces=torques)
                else:
                    body.apply(torques)
                world.step()
            rates.append(rates_of(body).tolist())
    assert np.abs(rates[0]).max() > 0
    assert rates[0] == rates[1]


@pytest.mark.parametrize(
    ("base", "error"), [("static", 1e-9), ("free", 1e-9), ("constrained", 1e-3)]
)
@pytest.mark.parametrize("size", [1e-6, 1.0])  # N·m
def test_the_mass_matrix_is_what_torques_meet(base: str, error: float, size: float) -> None:
    """A torque on one joint, from rest, changes rates by its column of the inverse."""
    plan = askew(base)
    angles = bent(plan.bodies[0].chain)
    n = len(angles)
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        columns = []
        for torques in size * np.eye(n):
            body.reset(angles, [0.0] * n)
            body.apply(torques.tolist())
            world.step()
            columns.append(rates_of(body) / STEP / size)
        mass = body.mass_matrix(angles)
    assert np.allclose(mass, mass.T, rtol=0, atol=1e-12 * np.abs(mass).max())
    assert np.allclose(mass @ np.array(columns).T, np.eye(n), rtol=0, atol=error)


def difference_of_bias(base: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the difference of bias forces of two motions, as computed and in the engine's step."""
    random = np.random.default_rng(seed)
    plan = askew(base)
    angles = bent(plan.bodies[0].chain)
    n = len(angles)
    reported, done = [], []
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        for _ in range(2):
            rates, spin = 3 * random.normal(size=n), 4 * random.normal(size=3)
            linear = random.normal(size=3)
            velocity = (tuple(linear), tuple(spin)) if base == "free" else None
            body.reset(angles, rates.tolist(), velocity)
            mass = body.mass_matrix(angles)
            reported.append(
                body.equivalent_joint_torques(body.bias(angles, rates.tolist(), spin.tolist()))
            )
            world.step()
            done.append(-mass @ (rates_of(body) - rates) / STEP)
    return reported[1] - reported[0], done[1] - done[0]


@pytest.mark.parametrize("base", ["static", "free"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_bias_forces_are_those_that_slow_the_joints(base: str, seed: int) -> None:
    reported, done = difference_of_bias(base, seed)
    assert np.abs(done).max() > 1e-4
    assert np.allclose(reported, done, rtol=0, atol=1e-9 * np.abs(done).max())


def test_a_held_base_has_the_bias_forces_of_a_static_one() -> None:
    reported = []
    for base in ("static", "constrained"):
        plan = plan_of_manipulators({"definition": ASKEW, "base": base})
        angles = bent(plan.bodies[0].chain)
        rates = np.random.default_rng(5).normal(size=(2, len(angles)))
        with BulletWorld(plan) as world:
            a, b = (world.bodies[0].bias(angles, one.tolist()) for one in rates)
        reported.append(b - a)
    assert np.abs(reported[0]).max() > 1e-5
    assert np.allclose(reported[0], reported[1], rtol=0, atol=1e-12)


def test_bias_forces_and_a_push_of_the_base_leave_every_velocity_as_it_is() -> None:
    plan = askew("free")
    random = np.random.default_rng(7)
    angles = bent(plan.bodies[0].chain)
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        for _ in range(3):
            rates, spin, linear = (3 * random.normal(size=size) for size in (len(angles), 3, 3))
            body.reset(angles, rates.tolist(), (tuple(linear), tuple(spin)))
            bias = body.bias(angles, rates.tolist(), spin.tolist())
            body.apply_base_wrench(bias[:6])
            body.apply(bias[6:].tolist())
            world.step()
            assert rates_of(body) == pytest.approx(rates, abs=1e-11)
            assert np.allclose(body.base_velocity(), (linear, spin), rtol=0, atol=1e-11)


@pytest.mark.parametrize("rpy", [[0, 0, 0], [0.4, -0.5, 0.6], [3.14159265, 0, 0]])
def test_the_bias_forces_hold_a_body_against_gravity(rpy: list[float]) -> None:
    gravity = [0.5, -1.0, -9.81]
    plan = plan_of_manipulators({"definition": ASKEW, "rpy": rpy}, gravity=gravity)
    angles = bent(plan.bodies[0].chain)
    still = [0.0] * len(angles)
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        body.reset(angles, still)
        body.apply(body.bias(angles, still).tolist())
        world.step()
        assert np.abs(rates_of(body)).max() < 1e-12


def test_the_bias_forces_leave_the_gravity_of_the_world_alone() -> None:
    plan = plan_of_manipulators(
        {"definition": ASKEW, "base": "free", **PLACED}, gravity=[0.5, -1.0, -9.81]
    )
    n = len(plan.bodies[0].chain.joints)
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        body.bias([0.1] * n, [0.2] * n, [1.0, 2.0, 3.0])
        body.reset([0.0] * n, [0.0] * n)
        world.step()
        velocity, _ = body.base_velocity()
        assert rates_of(body) == pytest.approx([0.0] * n, abs=1e-10)
        assert velocity == pytest.approx(STEP * np.array([0.5, -1.0, -9.81]), abs=1e-12)


def test_the_engine_adds_no_damping_and_no_limit_to_the_rates() -> None:
    wheel = hinge(0, 0, 1, joint_type="continuous", limits=None, spring_stiffness=0)
    plan = plan_of_manipulators({"definition": manipulator(actuator(1, wheel))})
    with BulletWorld(plan) as world:
        body = world.bodies[0]
        body.reset([0.0], [500.0])
        for _ in range(1000):
            world.step()
        assert rates_of(body) == pytest.approx([500.0], rel=1e-9)


# what holds and what resists


def bending(base: str, rpy: list[float], integrator: str) -> np.ndarray:
    one = {
        "definition": "finger.yaml",
        "base": base,
        "position": [0.1, -0.2, 0.3],
        "rpy": rpy,
        "actuation": [
            {"actuator": 0, "axis": axis, "waypoints": [[0, 0], [0.3, 0.03]]} for axis in (0, 1)
        ],
    }
    record = {"columns": ["joint_angles", "base_pose"], "every": 10}
    plan = plan_of_manipulators(one, gravity=[0, 0, -9.81], integrator=integrator, record=record)
    return np.array(rows_of(plan, 600))


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
@pytest.mark.parametrize("rpy", [[0, 0, 0], [0.4, -0.5, 0.6]])
def test_a_constrained_base_is_held(rpy: list[float], integrator: str) -> None:
    static, held = (bending(base, rpy, integrator) for base in ("static", "constrained"))
    assert np.abs(static[:, 1:11]).max() > 0.3
    assert np.allclose(held[:, 1:11], static[:, 1:11], rtol=0, atol=1e-3)
    assert np.abs(held[:, 11:14] - [0.1, -0.2, 0.3]).max() < 1e-4
    assert np.allclose(held[:, 14:], static[:, 14:], rtol=0, atol=1e-3)


@pytest.mark.parametrize("scale", [1, 20])
def test_dry_friction_holds_a_joint_until_it_slips(scale: float) -> None:
    joint = hinge(1, 0, 0, spring_stiffness=0, spring_damping=0, joint_control_limit_force=0.01)

    def last_angle(torque: float) -> float:
        drive = {"actuator": 0, "axis": 0, "torque": torque}
        one = {"definition": manipulator(actuator(1, joint)), "actuation": [drive]}
        record = {"columns": ["joint_angles"], "every": 20}
        plan = plan_of_manipulators(one, world_scale=scale, record=record, time_step=1e-4)
        return rows_of(plan, 20)[-1][1]

    for torque in (0.0, 0.005, 0.0099, -0.0099):
        assert abs(last_angle(torque)) < 1e-9
    link = (
        plan_of_manipulators({"definition": manipulator(actuator(1, joint))})
        .bodies[0]
        .chain.links[1]
    )
    inertia = link.inertial.inertia[0] + link.inertial.mass * link.inertial.centre[2] ** 2
    for torque in (0.0101, 0.015, -0.015):
        # a constant torque, less the friction, over 2 ms
        excess = torque - np.copysign(0.01, torque)
        assert last_angle(torque) == pytest.approx(0.5 * excess / inertia * 0.002**2, rel=0.06)


def test_bodies_cannot_pass_through_each_other() -> None:
    """A finger that swings into a wall is stopped by it, and swings on without it."""
    wall = {"shape_type": "box", "dimensions": [0.2, 0.02, 0.2], "mass": 1}
    behind = {
        "name": "wall",
        "definition": manipulator(actuator(1, X), base_definition=wall),
        "position": [0, -0.06, 0],
    }
    finger = {
        "name": "finger",
        "definition": "finger.yaml",
        "actuation": [{"actuator": 0, "axis": 0, "torque": 0.05}],
    }
    record = {"columns": ["tip_position"], "every": 10}
    lowest = []
    for bodies in ((finger,), (finger, behind)):
        plan = plan_of_manipulators(*bodies, record=record, world_scale=20)
        lowest.append(np.array(rows_of(plan, 200))[:, 2].min())
    # the wall's face, less the radius of the tip
    assert lowest[0] < -0.06
    assert lowest[1] > -0.05


def test_joint_limits_hold() -> None:
    joint = {**Y, "limits": [-0.2, 0.1, 1, 1], "spring_stiffness": 0.001}
    drive = {"actuator": 0, "axis": 0, "torque": 0.002}
    one = {"definition": manipulator(actuator(2, joint)), "actuation": [drive]}
    plan = plan_of_manipulators(one, record={"columns": ["joint_angles"]})
    angles = np.array(rows_of(plan, 500))[:, 1:]
    assert angles.max() < 0.105
    assert angles[-1] == pytest.approx([0.1, 0.1], abs=1e-3)


@pytest.mark.parametrize("integrator", ["implicit", "euler", "explicit"])
def test_a_plan_that_keeps_everything_has_every_row(integrator: str) -> None:
    scene = scene_from_file("scene.yaml", "gravity=[0, 0, 0]", f"integrator={integrator}")
    for is_whole in (False, True):
        plan = make_plan(scene, is_whole)
        joints = plan.bodies[0].chain.joints
        with BulletWorld(plan) as world:
            body = world.bodies[0]
            body.reset([0.0] * len(joints), [1.0] * len(joints))
            world.step()
            motors = {abs(state[3]) for state in body.joint_states()}
            pushed = []
            for index, joint in enumerate(joints):
                for beyond in (joint.lower - 0.01, joint.upper + 0.01):
                    angles = [0.0] * len(joints)
                    angles[index] = beyond
                    body.reset(angles, [0.0] * len(joints))
                    world.step()
                    pushed.append(rates_of(body)[index] * beyond < 0)
        assert motors == {ZERO_EFFECT_TORQUE if is_whole else 0.0}
        assert set(pushed) == {is_whole or integrator == "explicit"}


def test_motors_that_are_idle_leave_dry_friction_alone() -> None:
    rubbing = {**X, "joint_control_limit_force": 0.01}
    scene = scene_from_text(
        json.dumps({"manipulators": [{"definition": manipulator(actuator(2, rubbing, X))}]})
    )
    reported = []
    for is_whole in (False, True):
        with BulletWorld(make_plan(scene, is_whole)) as world:
            body = world.bodies[0]
            body.reset([0.0, 0.0], [100.0, 100.0])
            world.step()
            reported.append([abs(state[3]) for state in body.joint_states()])
    assert reported == [[pytest.approx(0.01), 0.0], [pytest.approx(0.01), ZERO_EFFECT_TORQUE]]


@pytest.mark.parametrize(("mass", "is_refused"), [(1e-12, False), (1e-13, True)])
def test_a_joint_that_the_engine_would_hold_is_refused(mass: float, is_refused: bool) -> None:
    """Below 2.2e-16 engine units of inertia PyBullet 3.2.7 holds a joint, and says nothing."""
    scene = scene_from_file("scene.yaml", f"world_scale={{length: 20, mass: {mass}}}")
    if not is_refused:
        usual = np.array(rows_of(scene_from_file("scene.yaml"), 20))
        assert np.array(rows_of(scene, 20)) == pytest.approx(usual, rel=1e-9, abs=1e-12)
        return
    with pytest.raises(EngineRefused, match=r"moves 8.3e-17 engine units of inertia"):
        rows_of(scene, 20)


def test_the_solver_takes_fewer_iterations_where_many_points_touch() -> None:
    assert [collision_filter.iteration_limit(points) for points in (0, 16, 17, 96)] == [
        200,
        200,
        50,
        50,
    ]
    one = {"definition": manipulator(actuator(2, X))}
    with BulletWorld(plan_of_manipulators(one, ground={"height": -9})) as world:
        for many in (17, 17, 3):
            world._report.count = many
            world.adapt_solver_iterations()
            reported = world.engine.getPhysicsEngineParameters()
            assert reported["numSolverIterations"] == collision_filter.iteration_limit(many)
