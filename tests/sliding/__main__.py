"""Print how bodies slide, heading by heading, and what they win on soft ground.

`python -m tests.sliding`; a few minutes.
"""

from __future__ import annotations

import math

from tests.sliding import plain_engine
from tests.sliding.headings import BODIES, HEADINGS, stop
from tests.sliding.soft_ground import SHAPES, STATES, won
from tests.sliding.uncorrected import uncorrected

STEPS = (2.5e-4, 1e-3, 2e-3)  # s
STEP_UNCORRECTED = 1e-3  # s
STIFF_CASES = (("ball", "falls"), ("ball", "slides"), ("cube", "falls"), ("cube", "rests"))
STIFFNESS_RATIOS = (0.1, 0.2, 0.3, 0.5, 1.0)


def plain() -> None:
    """Print how a long box slides in plain PyBullet, parameter by parameter."""
    print("plain PyBullet, a long box, 1 ms: distance over v^2/(2 mu g) - 1, aside over it")
    for name, beyond, aside in plain_engine.rows():
        print(f"{name:24}{beyond:9.4f} {aside:9.4f}", flush=True)


def sliding() -> None:
    """Print the worst of all headings for every body and step."""
    print(
        "worst of 16 headings and yaws: distance over v^2/(2 mu g) - 1, aside over it, turned [rad]"
    )
    for body in BODIES:
        with uncorrected():
            print(f"{body:10}engine's {_worst_stop(body, STEP_UNCORRECTED)}", flush=True)
        for step in STEPS:
            print(f"{body:10}{1e3 * step:>5g} ms {_worst_stop(body, step)}", flush=True)


def _worst_stop(body: str, step: float) -> str:
    turns = (2 * math.pi * k / HEADINGS + 0.1 for k in range(HEADINGS))
    stops = [stop(body, turn, 0.349 * k, step) for k, turn in enumerate(turns)]
    parts = zip(*((one.beyond, one.aside, one.turned) for one in stops), strict=True)
    return " ".join(f"{max(map(abs, part)):9.5f}" for part in parts)


def soft() -> None:
    """Print what every body wins on soft ground, over what it had, and its tilt [degrees]."""
    print("won on soft ground, over what there was; largest tilt [degrees]")
    print(f"{'':18}{'engine, 1 ms':>16}" + "".join(f"{1e3 * step:>13g} ms" for step in STEPS))
    for body in SHAPES:
        for state in STATES:
            with uncorrected():
                found = [won(body, state, STEP_UNCORRECTED)]
            found += [won(body, state, step) for step in STEPS]
            reported = "".join(f"{gain:>9.4f} {tilt:>6.1f}" for gain, tilt in found)
            print(f"{body:9}{state:9}{reported}", flush=True)


def stiff() -> None:
    """Print what a ball and a cube win over how stiff the ground is for their mass and step."""
    print(
        "won at 1 ms over step x root of stiffness / mass; damping 0.66 of root (stiffness x mass)"
    )
    print(f"{'':6}" + "".join(f"{body + ' ' + state:>14}" for body, state in STIFF_CASES))
    for ratio in STIFFNESS_RATIOS:
        gains = (_won_over_stiffness(body, state, ratio) for body, state in STIFF_CASES)
        print(f"{ratio:6g}" + "".join(f"{gain:14.4f}" for gain in gains), flush=True)


def _won_over_stiffness(body: str, state: str, ratio: float) -> float:
    mass = float(SHAPES[body]["mass"])
    stiffness = mass * (ratio / STEP_UNCORRECTED) ** 2
    damping = 0.66 * math.sqrt(stiffness * mass)
    return won(body, state, STEP_UNCORRECTED, stiffness=stiffness, damping=damping)[0]


if __name__ == "__main__":
    plain()
    sliding()
    soft()
    stiff()
