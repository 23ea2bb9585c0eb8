"""Where the time of a step goes: our loop on the finger of 10, 40 and 80 joints, and on the hand.

Run by `make bench`. Each part's time is its own, that of parts within it taken away. Looking at the
clock costs time as well, so the parts add up to more than a step takes without.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from typing import Any
from unittest.mock import patch

from somo_cli.simulation import run as stepping
from somo_cli.simulation.engine.bullet.body import BulletBody
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.joint_inertia import JointInertia
from somo_cli.simulation.integrator.joint_work import JointWork
from somo_cli.simulation.integrator.law_stepper import LawStepper
from somo_cli.simulation.integrator.reused_correction import ReusedCorrection
from somo_cli.simulation.loop import SimulationLoop
from somo_cli.simulation.monitoring.divergence import DivergenceMonitor
from somo_cli.simulation.plan.model import Plan
from tests.bench import hand
from tests.bench import stepping as finger

STEPS = 1000
ROUNDS = 5
PARTS: dict[str, tuple[tuple[type | Any, str], ...]] = {
    "engine: inverse dynamics": ((BulletBody, "bias"),),
    "engine: inertia": ((BulletBody, "mass_matrix"),),
    "law: corrected torques": ((SpringDamperLaw, "predict"), (SpringDamperLaw, "settle")),
    "law: reused torques": ((ReusedCorrection, "torques"),),
    "law: new inertia": ((SpringDamperLaw, "refresh"), (JointInertia, "refresh")),
    "checks: whether a correction may be reused": ((LawStepper, "apply_at_check"),),
    "actuation": ((BodyStepper, "actuate"), (SimulationLoop, "_is_steady")),
    "divergence monitor": (
        (BodyStepper, "measure"),
        (JointWork, "count_step"),
        (JointWork, "count"),
        (DivergenceMonitor, "update"),
    ),
    "loop": ((SimulationLoop, "advance"),),
}


@dataclass
class Account:
    """Own time [s] of each part and how often it was entered."""

    seconds: dict[str, float] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    _within: list[float] = field(default_factory=lambda: [0.0])

    def of(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function, its time taken for a part."""

        def timed(*arguments: Any) -> Any:
            self._within.append(0.0)
            started = time.perf_counter()
            found = function(*arguments)
            taken = time.perf_counter() - started
            own = taken - self._within.pop()
            self._within[-1] += taken
            self.seconds[name] = self.seconds.get(name, 0.0) + own
            self.counts[name] = self.counts.get(name, 0) + 1
            return found

        return timed


@contextmanager
def taken_apart(account: Account) -> Iterator[None]:
    """Measure the time of every part of the loop."""
    made_pull, entered = BodyStepper._make_read_state, BulletWorld.__enter__

    def enter(world: BulletWorld) -> BulletWorld:
        entered(world)
        world.step = account.of("engine: step", world.step)
        for body in world.bodies:
            body.apply = account.of("engine: torques written", body.apply)
            body.joint_states = account.of("engine: state read", body.joint_states)
        return world

    with ExitStack() as stack:
        for name, places in PARTS.items():
            for owner, function in places:
                timed = account.of(name, getattr(owner, function))
                stack.enter_context(patch.object(owner, function, _as_method(timed)))
        pull: Any = lambda body_stepper: account.of("state to array", made_pull(body_stepper))  # noqa: E731
        stack.enter_context(patch.object(BodyStepper, "_make_read_state", pull))
        stack.enter_context(patch.object(BulletWorld, "__enter__", enter))
        yield


def _as_method(timed: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *arguments: timed(*arguments)


def parts(plan: Plan) -> tuple[float, Account]:
    """Return the time of a step [us] without measuring, and the account of the fastest round."""
    plain = min(_run(plan) for _ in range(ROUNDS))
    found: list[tuple[float, Account]] = []
    for _ in range(ROUNDS):
        account = Account()
        with taken_apart(account):
            found.append((_run(plan), account))
    return plain, min(found, key=lambda one: one[0])[1]


def _run(plan: Plan) -> float:
    with BulletWorld(plan) as world:
        run = stepping.run(plan, world, lambda values: None, STEPS, time.perf_counter)
    return run.wall_time / STEPS * 1e6


def main() -> None:
    """Print a table for each body."""
    plans = {f"{joints} joints": finger.finger_plan(joints) for joints in (10, 40, 80)}
    plans["hand of four fingers, ten joints each, and a cube"] = hand.plan_of_hand()
    for name, plan in plans.items():
        plain, account = parts(plan)
        total = sum(account.seconds.values()) / STEPS * 1e6
        print(f"\n{name}: {plain:.1f} us a step; taken apart {total:.1f} us")
        print("  us a step   times in 1000 steps   part")
        for part, seconds in sorted(account.seconds.items(), key=lambda one: -one[1]):
            print(f"  {seconds / STEPS * 1e6:9.2f}{account.counts[part]:12}             {part}")


if __name__ == "__main__":
    main()
