"""Print the contact bench: `make contact`; --quick for the plain law and a few cases."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

from somo_cli.problems import SimulationDiverged
from tests.contact import chatter, second_opinion, table
from tests.contact.candidates import EULER, EXPLICIT, PLAIN, Candidate, candidates
from tests.contact.cases import Case, cases, named
from tests.contact.table import Line
from tests.contact.trial import recorded, trial, truth

QUICK = ("blocked force", "wall struck, fast", "cube of 10 g, 2 fingers")
SENSITIVE = 3e-3  # relative change at the finest step, beyond which there is no convergence
TOO_LARGE = (5e-3, 6e-3, 8e-3, 1e-2, 2e-2)  # s
EXPLICIT_STEP = 2.5e-4  # s, below the finger's limit of 0.38 ms


def show(case: Case, laws: Sequence[Candidate]) -> list[Line]:
    """Print the table of a case, and return its lines."""
    known = truth(case.name)
    print(f"\n{case.name}, {case.what}: {known.figure:.6g} +- {known.spread:.1g}")
    if known.spread > SENSITIVE * abs(known.figure):
        print("  sensitive: it scatters with the step, however small, by more than that")
    print(*_others(case, known.figure), sep="\n")
    print(table.header())
    plain = table.measured(PLAIN, case)
    lines = []
    for law in laws:
        line = plain if law is PLAIN else table.measured(law, case)
        lines.append(line)
        print(table.text(line, plain), flush=True)
    if case.is_passive:
        grown = " ".join(f"{one.growth:.1e}" for one in plain.trials)
        print(f"  energy won again by the plain law, over what was lost: {grown}")
    return lines


def _others(case: Case, figure: float) -> list[str]:
    coarse = trial(case, EXPLICIT_STEP, EXPLICIT).figure
    error = "fails" if math.isnan(coarse) else f"{abs(coarse / figure - 1):.1e}"
    reported = [f"  explicit at {1e3 * EXPLICIT_STEP:g} ms: {error}"]
    if not case.is_slow:
        apart = " and ".join(f"{one:.1e}" for one in second_opinion.apart(case, figure))
        reported.append(f"  MuJoCo at 40 and 20 us: {apart} from it")
    return reported


def shaking() -> None:
    """Print how much a sliding finger shakes whose dampers outweigh its inertia."""
    print("\nshaking of a finger that slides on the ground, of its worst joint [rad]")
    print(f"{'':22}" + "".join(f"{1e3 * step:>8g} ms" for step in chatter.STEPS))
    for dampers in chatter.DAMPERS:
        print(f"dampers x {dampers}")
        for law in candidates():
            found = [chatter.shake(law, dampers, step) for step in chatter.STEPS]
            print(f"  {law.name:20}" + "".join(f"{one:>11.1e}" for one in found), flush=True)


def too_large() -> None:
    """Print how fast impacts end at steps beyond the ladder, and what a run reports of them."""
    print("\nat too large steps: relative error, and what the run says")
    for name in ("wall struck, fast", "block struck, fast", "cube of 100 g, 2 fingers"):
        case = named(name)
        for step in TOO_LARGE:
            try:
                columns, summary = recorded(case, step)
            except SimulationDiverged as error:
                found, said = "", str(error)
            else:
                found = f"{abs(case.figure(columns) / truth(name).figure - 1):.1e}"
                deepest = summary.deepest
                is_deep = deepest is not None and deepest.is_deep
                said = (
                    f"{100 * deepest.depth_ratio:.0f} % deep" if deepest and is_deep else "nothing"
                )
            print(f"  {name:26}{1e3 * step:>5g} ms {found:>8}  {said}")


def main() -> None:
    """Print a table for each case, then the worst over all cases."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--quick", action="store_true")
    arguments.add_argument("--case", action="append", help="a part of a case's name")
    options = arguments.parse_args()
    wanted = QUICK if options.quick else options.case
    lines = []
    print("relative errors of a figure of each case; cost: time of a step over the plain law's")
    for case in cases():
        if wanted and not any(part in case.name for part in wanted):
            continue
        few = options.quick or case.is_slow
        lines += show(case, (PLAIN, EULER) if few else candidates())
    print("\nworst over these cases, where the truth is known no better than that")
    print(table.header())
    print(*table.worst(lines), sep="\n")
    if not wanted:
        too_large()
        shaking()


if __name__ == "__main__":
    main()
