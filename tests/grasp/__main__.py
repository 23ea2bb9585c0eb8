"""Print the bench of grasps: `make grasp`; --case for those of which the name has a part."""

from __future__ import annotations

import argparse

from tests.grasp.cases import cases
from tests.grasp.trial import FINE, Verdict, converged, verdict

STEPS = (5e-4, 1e-3, 2e-3)


def main() -> None:
    """Print a line for each case: shaking, error of the grip and of the place, at each step."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--case", action="append", help="a part of a case's name")
    wanted = arguments.parse_args().case
    print("deviation of the force / its mean, error of the grip, object off / its size;")
    print(f"converged: {1e3 * FINE:g} ms; ! where one is above 0.2 %, 1 %, 1 %")
    print(f"{'':52}{'force [N]':>10}" + "".join(f"{1e3 * step:>26g} ms" for step in STEPS))
    failed = 0
    for grasp in cases():
        if wanted and not any(part in grasp.name for part in wanted):
            continue
        fine = converged(grasp)
        line = f"{grasp.name:52}{fine.force:>8.3f} +-{fine.deviation / fine.force:.0e}"
        for step in STEPS:
            one = verdict(grasp, step)
            failed += not one.is_good
            line += _text(one)
        print(line, flush=True)
    print(f"{failed} runs are not good")


def _text(one: Verdict) -> str:
    return f"  {one.shaking:8.1e}{one.grip:8.1e}{one.place:8.1e}{' ' if one.is_good else '!'}"


if __name__ == "__main__":
    main()
