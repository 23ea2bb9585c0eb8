"""Print the contact bench: `make contact`; --quick for the plain law and a few cases."""

from __future__ import annotations

import argparse

from tests.contact import table
from tests.contact.candidates import PLAIN, candidates
from tests.contact.cases import cases
from tests.contact.trial import truth

QUICK = ("blocked force", "wall struck, fast", "cube of 10 g, 2 fingers")


def main() -> None:
    """Print a table for each case, then the worst over all cases."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--quick", action="store_true")
    arguments.add_argument("--case", action="append", help="a part of a case's name")
    options = arguments.parse_args()
    wanted = QUICK if options.quick else options.case
    laws = (PLAIN,) if options.quick else candidates()
    lines = []
    print("relative errors of a figure of each case; cost: time of a step over the plain law's")
    for case in cases():
        if wanted and not any(part in case.name for part in wanted):
            continue
        known = truth(case.name)
        print(f"\n{case.name}, {case.what}: {known.figure:.6g} +- {known.spread:.1g}")
        print(table.header())
        plain = table.measured(PLAIN, case)
        for law in laws:
            line = plain if law is PLAIN else table.measured(law, case)
            lines.append(line)
            print(table.text(line, plain), flush=True)
    print("\nworst over all cases, where the truth is known no better than that")
    print(table.header())
    print(*table.worst(lines), sep="\n")


if __name__ == "__main__":
    main()
