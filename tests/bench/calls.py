"""What a user's own loop costs: `Simulation.step` ten steps at a time against many at once.

Run by `make bench`. Both ways take turns in one simulation, each time for the same number of steps;
printed are the median of the ratio over the rounds, and what a call costs beside its steps.
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
    whole: list[float] = []
    by_call: list[float] = []
    with somo.Simulation(DEFINITIONS / scene) as simulation:
        simulation.step(AT_ONCE * CALLS)
        for _ in range(rounds):
            started = time.process_time()
            simulation.step(AT_ONCE * CALLS)
            middle = time.process_time()
            for _ in range(CALLS):
                simulation.step(AT_ONCE)
            by_call.append(time.process_time() - middle)
            whole.append(middle - started)
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
