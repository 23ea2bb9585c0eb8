"""Print how bodies slide, heading by heading, and what they win on soft ground.

`python -m tests.sliding`; a few minutes.
"""

from __future__ import annotations

import math

from tests.sliding.headings import BODIES, HEADINGS, stop
from tests.sliding.soft_ground import SHAPES, STATES, won

STEPS = (2.5e-4, 1e-3, 2e-3)  # s


def sliding() -> None:
    """Print the worst of all headings for every body and step."""
    print("worst of 16 headings and yaws: way over v^2/(2 mu g) - 1, aside over it, turned [rad]")
    for body in BODIES:
        for step in STEPS:
            turns = (2 * math.pi * k / HEADINGS + 0.1 for k in range(HEADINGS))
            stops = [stop(body, turn, 0.349 * k, step) for k, turn in enumerate(turns)]
            parts = zip(*((one.beyond, one.aside, one.turned) for one in stops), strict=True)
            worst = " ".join(f"{max(map(abs, part)):9.5f}" for part in parts)
            print(f"{body:10}{1e3 * step:>6g} ms {worst}", flush=True)


def soft() -> None:
    """Print what every body wins on soft ground, over what it had, and its tilt [degrees]."""
    print("won on soft ground, over what there was; largest tilt [degrees]")
    print(f"{'':18}" + "".join(f"{1e3 * step:>13g} ms" for step in STEPS))
    for body in SHAPES:
        for state in STATES:
            found = (won(body, state, step) for step in STEPS)
            reported = "".join(f"{gain:>9.4f} {tilt:>6.1f}" for gain, tilt in found)
            print(f"{body:9}{state:9}{reported}", flush=True)


if __name__ == "__main__":
    sliding()
    soft()
