"""Several bodies' laws in one product: what it would save of a step, against one product each.

Run by `make bench`. Fingers of ten joints stand side by side in the air, their corrections held, as
in most steps of a calm run. One by one is what the product does. Stacked, one state of all fingers
is filled at once from what the engine returns, and multiplied either by a batch of matrices, or by
a single one with those of the fingers along its diagonal. The engine's calls are the same: one
reads and one writes each finger. Printed are medians over rounds in which the variants take turns,
and what stacking would save of a step of our loop at most, were all fingers held in every step.
"""

from __future__ import annotations

import argparse
import itertools
import json
import statistics
import struct
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from operator import itemgetter
from typing import TypeAlias

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation import run as stepping
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.half_step_start import begin
from somo_cli.simulation.integrator.reused_correction import ReusedCorrection
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.bench import hand
from tests.builders.scenes import scene_from_text

FINGERS = (1, 2, 4, 8)
JOINTS = 10
STEPS = 500
CLOCK = time.perf_counter

Step: TypeAlias = Callable[[], None]
Product: TypeAlias = Callable[[Sequence[ReusedCorrection], Array], Callable[[], list[float]]]


def plan_of_fingers(count: int) -> Plan:
    """Return the plan of so many fingers of the hand, too far from each other to meet."""
    fingers = [hand.finger(number) | {"position": [number, 0, 0]} for number in range(count)]
    data = {"manipulators": fingers, "record": {"every": STEPS, "columns": ["joint_angles"]}}
    return make_plan(scene_from_text(json.dumps(data)))


@contextmanager
def begun(plan: Plan) -> Iterator[tuple[BulletWorld, list[BodyStepper]]]:
    """Enter a world with every finger at its start, a correction held that is nothing yet."""
    with BulletWorld(plan) as world:
        body_steppers = [
            BodyStepper(plan, *pair) for pair in zip(plan.bodies, world.bodies, strict=True)
        ]
        begin(plan, world, body_steppers)
        for body_stepper in body_steppers:
            body_stepper.law_stepper.reused.extrapolate(np.zeros(JOINTS), np.zeros(JOINTS), 8)
        yield world, body_steppers


def one_by_one(world: BulletWorld, body_steppers: Sequence[BodyStepper]) -> Step:
    """Return a step as the product does it."""
    pushes, pulls = (
        [one.law_stepper.apply_reused for one in body_steppers],
        [one.read_state for one in body_steppers],
    )
    advance = world.step

    def step() -> None:
        for push in pushes:
            push()
        advance()
        for pull in pulls:
            pull()

    return step


def stacked(product: Product) -> Callable[[BulletWorld, Sequence[BodyStepper]], Step]:
    """Return what makes a step that multiplies all fingers' states at once."""

    def of_world(world: BulletWorld, body_steppers: Sequence[BodyStepper]) -> Step:
        advance, size = world.step, 2 * len(body_steppers) * JOINTS
        angle, rate, pack = itemgetter(0), itemgetter(1), struct.Struct(f"{size}d").pack_into
        laws = [body_stepper.law for body_stepper in body_steppers]
        reused = [body_stepper.law_stepper.reused for body_stepper in body_steppers]
        # of all fingers: their angles, then their rates
        motion = np.concatenate([law.angles for law in laws] + [law.rates for law in laws])
        torques = product(reused, motion)
        parts = [slice(first, first + JOINTS) for first in range(0, size // 2, JOINTS)]
        writes = [
            (one.world_body.apply, part) for one, part in zip(body_steppers, parts, strict=True)
        ]
        reads = [one.world_body.joint_states for one in body_steppers]
        data, chain = motion.data, itertools.chain.from_iterable

        def step() -> None:
            values = torques()
            for apply, part in writes:
                apply(values[part])
            advance()
            states = [read() for read in reads]
            pack(data, 0, *map(angle, chain(states)), *map(rate, chain(states)))

        return step

    return of_world


def by_batch(laws: Sequence[ReusedCorrection], motion: Array) -> Callable[[], list[float]]:
    """Return what gives the torques by a batch of products, from the motion as it is then."""
    count, n = len(laws), JOINTS
    state = np.array([law.state.vector for law in laws])
    matrices = np.array([law.torque_map for law in laws])
    found = np.zeros((count, 1, n))
    angles, rates, previous, applied = (
        state[:, first : first + n] for first in range(n + 2, 5 * n + 2, n)
    )
    read_angles, read_rates = motion.reshape(2, count, n)
    rows, reported, flat = state[:, np.newaxis], found[:, 0], found.reshape(-1)
    share, eighth, matmul = state[:, 0], np.array(1 / 8), np.matmul

    def torques() -> list[float]:
        np.add(share, eighth, share)
        angles[:], rates[:] = read_angles, read_rates
        matmul(rows, matrices, found)
        previous[:], applied[:] = read_rates, reported
        values: list[float] = flat.tolist()
        return values

    return torques


def on_diagonal(laws: Sequence[ReusedCorrection], motion: Array) -> Callable[[], list[float]]:
    """Return what gives the torques by one product, a matrix with all along its diagonal."""
    n, size = JOINTS, len(laws) * JOINTS
    # growth and one, u, q, v, v_prev, τ_prev: each of all fingers
    state = np.zeros(2 + 5 * size)
    matrix = np.zeros((2 + 5 * size, size))
    for number, law in enumerate(laws):
        own = slice(number * n, (number + 1) * n)
        matrix[:2, own], state[:2] = law.torque_map[:2], law.state.vector[:2]
        for block in range(5):
            rows = slice(2 + block * size + own.start, 2 + block * size + own.stop)
            of_law = slice(2 + block * n, 2 + (block + 1) * n)
            matrix[rows, own], state[rows] = law.torque_map[of_law], law.state.vector[of_law]
    found, share = np.zeros(size), state[:1].data
    now, before = state[2 + size : 2 + 3 * size].data, state[2 + 3 * size : 2 + 4 * size].data
    applied, both, rates = state[2 + 4 * size :].data, motion.data, motion[size:].data
    dot, reported, tolist = state.dot, found.data, found.tolist

    def torques() -> list[float]:
        share[0] += 0.125
        now[:] = both
        dot(matrix, found)
        before[:], applied[:] = rates, reported
        values: list[float] = tolist()
        return values

    return torques


VARIANTS: dict[str, Callable[[BulletWorld, Sequence[BodyStepper]], Step]] = {
    "one by one": one_by_one,
    "batch": stacked(by_batch),
    "diagonal": stacked(on_diagonal),
}


def microseconds(plan: Plan, variant: str) -> float:
    """Time a step in which every finger's correction is held [us]; the engine's part included."""
    with begun(plan) as (world, body_steppers):
        step = VARIANTS[variant](world, body_steppers)
        started = CLOCK()
        for _ in range(STEPS):
            step()
        return (CLOCK() - started) / STEPS * 1e6


def result_of(plan: Plan, variant: str) -> np.ndarray:
    """Return where the joints are after some held steps, of all fingers [rad]."""
    with begun(plan) as (world, body_steppers):
        step = VARIANTS[variant](world, body_steppers)
        for _ in range(STEPS):
            step()
        return np.array([state[0] for body in world.bodies for state in body.joint_states()])


def microseconds_of_ours(plan: Plan) -> float:
    """Time a step of our loop, all of it [us]."""
    with BulletWorld(plan) as world:
        summary = stepping.run(plan, world, lambda values: None, STEPS, CLOCK)
    return summary.wall_time / STEPS * 1e6


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rounds", type=int, default=9)
    rounds = arguments.parse_args().rounds
    print("fingers in the air, corrections held: a step in us, and what stacking saves of our step")
    names = "".join(f"{one:>12}" for one in VARIANTS)
    print(f"fingers  {names}    our step    saved: batch  diagonal")
    for count in FINGERS:
        plan = plan_of_fingers(count)
        results = [result_of(plan, variant) for variant in VARIANTS]
        assert all(np.allclose(results[0], other, rtol=0, atol=1e-9) for other in results[1:])
        found: dict[str, list[float]] = {variant: [] for variant in VARIANTS}
        whole = []
        for _ in range(rounds):
            for variant, times in found.items():
                times.append(microseconds(plan, variant))
            whole.append(microseconds_of_ours(plan))
        medians = {variant: statistics.median(times) for variant, times in found.items()}
        ours = statistics.median(whole)
        cells = "".join(f"{one:12.1f}" for one in medians.values())
        shares = [
            (medians["one by one"] - medians[variant]) / ours for variant in ("batch", "diagonal")
        ]
        print(f"{count:7d}  {cells}{ours:12.1f}{shares[0]:16.1%}{shares[1]:10.1%}", flush=True)


if __name__ == "__main__":
    main()
