"""What a user's own loop costs: `Simulation.step` ten steps at a time against many at once.

Run by `make bench`. Two simulations of a scene take the same steps, in turn and in either order:
one at once, the other ten at a time. In one simulation the two ways would get different steps, of
which some have contact. Printed are the median of the ratio over the rounds, and what a call costs
beside its steps.
"""

from __future__ import annotations

import statistics
import time
from pathlib import Path

import somo_cli as somo

DEFINITIONS = Path(__file__).parents[2] / "definitions"
AT_ONCE = 10
CALLS = 8
ROUNDS = 300


def costs(scene: str, rounds: int = ROUNDS) -> tuple[float, float, float]:
    """Return the time of a step [us] taken at once, that by ten over it, and us for each call."""
    times: dict[int, list[float]] = {AT_ONCE: [], AT_ONCE * CALLS: []}
    path = DEFINITIONS / scene
    with somo.Simulation(path) as first, somo.Simulation(path) as second:
        ways = [(first, AT_ONCE * CALLS), (second, AT_ONCE)]
        for _ in range(rounds):
            for simulation, steps in ways:
                started = time.process_time()
                for _ in range(AT_ONCE * CALLS // steps):
                    simulation.step(steps)
                times[steps].append(time.process_time() - started)
            ways.reverse()
    by_call, whole = times.values()
    ratio = statistics.median(one / other for one, other in zip(by_call, whole, strict=True))
    step = statistics.median(whole) / (AT_ONCE * CALLS)
    return 1e6 * step, ratio, 1e6 * step * AT_ONCE * (ratio - 1)


def main() -> None:
    """Print a line for each scene."""
    print("\nscene               us a step   step(10) over one call   us for each call")
    for scene in ("scene.yaml", "hand_scene.yaml", "push_scene.yaml"):
        step, ratio, call = costs(scene)
        print(f"{scene:18}{step:11.1f}{ratio:25.3f}{call:19.1f}")


if __name__ == "__main__":
    main()
