"""Print the bench of grasps: `make grasp`; --case for those of which the name has a part."""

from __future__ import annotations

import argparse

from tests.grasp.cases import RADIUS, Grasp, cases
from tests.grasp.equal_error import print_tables
from tests.grasp.mujoco_grasp import held_in_mujoco
from tests.grasp.trial import FINE, Verdict, compared, converged, verdict, why_not_counted

STEPS = (5e-4, 1e-3, 2e-3)


def main() -> None:
    """Print a line for each case, with MuJoCo beside some, then what equal error costs."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--case", action="append", help="a part of a case's name")
    arguments.add_argument("--without-times", action="store_true", help="leave out equal error")
    asked = arguments.parse_args()
    print("deviation of the force / its mean, error of the grip, object off / its size;")
    print(f"converged: {1e3 * FINE:g} ms; ! where one is above 0.2 %, 1 %, 1 %")
    print(f"{'':62}{'force [N]':>10}" + "".join(f"{1e3 * step:>26g} ms" for step in STEPS))
    failed, runs = 0, 0
    for grasp in cases():
        if asked.case and not any(part in grasp.name for part in asked.case):
            continue
        failed += _print_case(grasp)
        runs += len(STEPS)
    print(f"{failed} of {runs} runs are not good for a reason that is the law's")
    if not asked.without_times:
        print_tables()


def _print_case(grasp: Grasp) -> int:
    """Print the line of a case, and what it says if a run is not good; return how many count."""
    fine = converged(grasp)
    verdicts = [verdict(grasp, step) for step in STEPS]
    line = f"{grasp.name:62}{fine.force:>8.3f} +-{fine.deviation / fine.force:.0e}"
    print(line + "".join(map(_text, verdicts)), flush=True)
    if grasp == Grasp(mass_ratio=grasp.mass_ratio):
        beside = [compared(fine, held_in_mujoco(grasp, step), 2 * RADIUS) for step in STEPS]
        print(f"{'  MuJoCo':62}{'':16}" + "".join(map(_text, beside)), flush=True)
    failed = sum(not one.is_good for one in verdicts)
    if not failed:
        return 0
    why = why_not_counted(grasp)
    if why:
        print(f"  {why}", flush=True)
    return 0 if why else failed


def _text(one: Verdict) -> str:
    return f"  {one.shaking:8.1e}{one.grip:8.1e}{one.place:8.1e}{' ' if one.is_good else '!'}"


if __name__ == "__main__":
    main()
