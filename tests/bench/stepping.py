"""Time of one step: ours against the bare engine, the classic loop and MuJoCo, on the same body.

Run by `make bench`. They are timed in turn, round after round, so that a machine whose speed drifts
does not favour one; printed are medians over the rounds, the medians of the ratios taken round by
round, and how fast cost grows with the number of joints. Times are those of the processor, which
other processes disturb least. Every loop starts from rest and bends the finger by the same torque
over half a second; ours and MuJoCo's record every 100th step.
"""

from __future__ import annotations

import argparse
import dataclasses
import statistics
import time
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation import run as stepping
from somo_cli.simulation.engine.bullet.body import BulletBody
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.bench.classic import leave_at_defaults
from tests.builders.mujoco_reference import mujoco_model
from tests.builders.scenes import scene_from_file

STEPS = 1000
STEPS_OF_CLASSIC = 200  # each costs the same, and those of long chains milliseconds
SWING = 0.01  # rad/s
JOINTS = (5, 10, 20, 40, 80, 120)
CLOCK = time.process_time


def finger_plan(joints: int) -> Plan:
    """Return the plan of the bench: the shipped scene, the finger cut into so many joints.

    Shape, mass and bending stiffness of the whole stay the same.
    """
    definition = "manipulators[0].definition.actuator_definitions[0]"
    actuator = scene_from_file("scene.yaml").manipulators[0].compiled.definition.actuators[0]
    share = actuator.n_segments / joints
    sets = [
        f"{definition}.n_segments={joints}",
        f"{definition}.link_definition.dimensions[2]={actuator.link.height * share}",
        f"{definition}.link_definition.mass={actuator.link.mass * share}",
    ]
    for index, joint in enumerate(actuator.joints[:2]):
        place = f"{definition}.joint_definitions[{index}]"
        sets.append(f"{place}.spring_stiffness={joint.stiffness / share}")
        sets.append(f"{place}.spring_damping={joint.damping / share}")
    scene = scene_from_file("scene.yaml", *sets)
    return make_plan(dataclasses.replace(scene, every=100, time_step=1e-3))


def microseconds_of_ours(plan: Plan) -> float:
    """Time our loop, all of it, recording included."""
    blocks: list[Array] = []
    with BulletWorld(plan) as world:
        summary = stepping.run(plan, world, blocks.append, STEPS, CLOCK)
    return summary.wall_time / STEPS * 1e6


def swing(body: BulletBody) -> None:
    """Let the joints turn to and fro by turns, too slowly to get far within the time measured."""
    count = len(body.links) - 1
    body.reset([0.0] * count, [SWING * (-1) ** number for number in range(count)])


def microseconds_of_bare(plan: Plan) -> float:
    """Time the engine alone, the body swinging slowly without gravity.

    Falling, it would hit its limits; at rest, it has less to compute.
    """
    with BulletWorld(dataclasses.replace(plan, gravity=(0.0, 0.0, 0.0))) as world:
        swing(world.bodies[0])
        started = CLOCK()
        for _ in range(STEPS):
            world.step()
        return (CLOCK() - started) / STEPS * 1e6


def microseconds_of_calls(plan: Plan) -> float:
    """Time the engine with the two calls that no loop in Python can do without, nothing else."""
    with BulletWorld(dataclasses.replace(plan, gravity=(0.0, 0.0, 0.0))) as world:
        body = world.bodies[0]
        swing(body)
        torques = [0.0] * len(plan.bodies[0].chain.joints)
        started = CLOCK()
        for _ in range(STEPS):
            body.apply(torques)
            world.step()
            body.joint_states()
        return (CLOCK() - started) / STEPS * 1e6


def microseconds_of_classic(plan: Plan) -> float:
    """Time the per-joint loop that users write, with the engine's joint motors left on.

    The motors hold a force that damps every joint, so the loop stays stable however stiff the
    springs are, which favours it.
    """
    with BulletWorld(plan) as world:
        body: BulletBody = world.bodies[0]
        bullet, client, index = body.engine.module, body.engine.number, body.index
        joints = plan.bodies[0].chain.joints
        leave_at_defaults(world, friction=1.0)
        started = CLOCK()
        for _ in range(STEPS_OF_CLASSIC):
            for joint, spring in enumerate(joints):
                angle = bullet.getJointState(index, joint, client)[0]
                torque = -spring.stiffness * (angle - spring.neutral_position)
                bullet.setJointMotorControl2(
                    index, joint, bullet.TORQUE_CONTROL, force=torque, physicsClientId=client
                )
            world.step()
        return (CLOCK() - started) / STEPS_OF_CLASSIC * 1e6


def microseconds_of_mujoco(plan: Plan) -> float:
    """Time MuJoCo on the same chain, one call a step from Python; contact and limits are off.

    Its integrator is `implicitfast`.
    """
    (body,) = plan.bodies
    model = mujoco_model(body.chain, plan.gravity, plan.time_step)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    state, rows = mujoco.MjData(model), []
    drives = [(drive.signal.at, list(drive.joints)) for drive in body.drives]
    started = CLOCK()
    for step in range(STEPS):
        for at, joints in drives:
            state.qfrc_applied[joints] = at(step * plan.time_step)
        mujoco.mj_step(model, state)
        if step % plan.every == 0:
            rows.append(state.qpos.copy())
    seconds = CLOCK() - started
    assert not any(warning.number for warning in state.warning), "MuJoCo gave the run up"
    return seconds / STEPS * 1e6


LOOPS: dict[str, Callable[[Plan], float]] = {
    "bare": microseconds_of_bare,
    "calls": microseconds_of_calls,
    "ours": microseconds_of_ours,
    "classic": microseconds_of_classic,
    "mujoco": microseconds_of_mujoco,
}
RATIOS = (("calls", "bare"), ("ours", "bare"), ("classic", "ours"), ("ours", "mujoco"))


def exponent(joints: Sequence[int], times: Sequence[float]) -> float:
    """Return p of the fit of times by c n^p."""
    return float(np.polyfit(np.log(joints), np.log(times), 1)[0])


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--joints", type=int, nargs="*", default=JOINTS)
    arguments.add_argument("--rounds", type=int, default=9)
    options = arguments.parse_args()
    print(f"{STEPS} steps of 1 ms, medians of {options.rounds} rounds, recording every 100th step")
    print("calls: bare + reading all joints + writing all torques, the floor of a loop in Python")
    print("times of a step in us, of the processor; ratios\n")
    ratios = "  ".join(f"{above}/{below}" for above, below in RATIOS)
    print(f"joints  {''.join(f'{name:>9}' for name in LOOPS)}  {ratios}  steps/s")
    medians: dict[str, list[float]] = {name: [] for name in LOOPS}
    for joints in options.joints:
        plan = finger_plan(joints)
        rounds = [{name: loop(plan) for name, loop in LOOPS.items()} for _ in range(options.rounds)]
        for name, found in medians.items():
            found.append(statistics.median(times[name] for times in rounds))
        cells = "".join(f"{found[-1]:9.1f}" for found in medians.values())
        for above, below in RATIOS:
            ratio = statistics.median(times[above] / times[below] for times in rounds)
            cells += f"{ratio:{len(above) + len(below) + 3}.2f}"
        print(f"{joints:6d}  {cells}  {1e6 / medians['ours'][-1]:7.0f}", flush=True)
    long = [index for index, joints in enumerate(options.joints) if joints >= 10]
    if len(long) > 1:
        n = [options.joints[index] for index in long]
        print(f"\ncost grows with joints, {n[0]} to {n[-1]}, as their number to the power of")
        for name, found in medians.items():
            print(f"  {name:8} {exponent(n, [found[index] for index in long]):4.2f}")


if __name__ == "__main__":
    main()
