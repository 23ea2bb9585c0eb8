"""Time of a step under external loads, in turn with that of the same beam without.

Run by `make bench`. The beam is the shipped cantilever of ten joints; each body is stepped from
rest. Printed are medians over the rounds of processor time, and of the ratios taken round by round.
Without a load the beam is at rest and its torques are constant, so the last row, a wave of torque,
shows what of a load is only that something changes in every step.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from somo_cli.arrays import Array
from somo_cli.simulation import run as stepping
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from tests.bench.stepping import CLOCK
from tests.builders.scenes import scene_from_text

STEPS = 4000
ROUNDS = 7
FORCE = "force: [0.05, 0, 0.01]"
MANY = ", ".join(
    f"{{link: actuator_0_segment_{number:02d}, {FORCE}, moment: [0, 0.01, 0]}}"
    for number in range(1, 11)
)
BODIES = {
    "without loads": "",
    "a dead load on the tip": f"loads: [{{link: tip, {FORCE}}}]",
    "a follower load on the tip": f"loads: [{{link: tip, {FORCE}, frame: body}}]",
    "a load that varies": f"loads: [{{link: tip, {FORCE}, waypoints: [[0, 0], [9, 1]]}}]",
    "ten loads, with moments": f"loads: [{MANY}]",
    "a wave of torque, no load": "actuation: "
    "[{actuator: 0, axis: 0, wave: {amplitude: 0.1, frequency: 1}}]",
}


def plan_of(body: str) -> Plan:
    """Return the plan of the cantilever with these loads, its last step recorded."""
    rest = f", {body}" if body else ""
    text = f"manipulators: [{{definition: cantilever.yaml{rest}}}]\nrecord: {{every: {STEPS}}}"
    return make_plan(scene_from_text(text))


def seconds_of(plan: Plan) -> float:
    """Return the processor time of all steps [s], opening the engine left out."""
    blocks: list[Array] = []
    with BulletWorld(plan) as world:
        return stepping.run(plan, world, blocks.append, STEPS, CLOCK).wall_time


def rows(rounds: int = ROUNDS) -> Sequence[tuple[str, float, float]]:
    """Return name, time of a step [us] and ratio to that without loads, of each body."""
    plans = {name: plan_of(body) for name, body in BODIES.items()}
    times: dict[str, list[float]] = {name: [] for name in plans}
    for _ in range(rounds):
        for name, plan in plans.items():
            times[name].append(seconds_of(plan))
    bare = times["without loads"]
    return [
        (
            name,
            statistics.median(found) / STEPS * 1e6,
            statistics.median(one / other for one, other in zip(found, bare, strict=True)),
        )
        for name, found in times.items()
    ]


def main() -> None:
    """Print the table."""
    print(f"{'ten joints':<30}{'us a step':>10}{'ratio':>8}")
    for name, microseconds, ratio in rows():
        print(f"{name:<30}{microseconds:>10.1f}{ratio:>8.2f}")


if __name__ == "__main__":
    main()
