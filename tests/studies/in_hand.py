"""In-hand manipulation: how far four soft fingers turn a cube, how surely, and on what it depends.

Runs that differ in the step, the world scale or by micrometres at the start show what of the result
is numerics; the same on a flat palm, what happens where contact leaves something undetermined; and
runs with other friction, stiffness and torque, what is open as long as those are not measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from tests.studies.in_hand_open import run_open
from tests.studies.in_hand_pictures import draw
from tests.studies.in_hand_turn import (
    CYCLES,
    FLAT_PALM,
    SCENE,
    SECONDS,
    STEP,
    Turn,
    moved,
    setting,
    turns,
)
from tests.studies.running import Setting

# °, in ten cycles, of the real hand and of SoMo's simulation of it: plot_fingergait.ipynb in
# examples/design_studies/ihm_fingergait of github.com/GrauleM/somo
MEASURED, SOMO = 536.0, 583.0
APART = 1.0  # °

SAME: Mapping[str, Setting] = {
    "step of 0.5 ms": setting(time_step=5e-4),
    "step of 1 ms, as shipped": setting(time_step=1e-3),
    "step of 2 ms": setting(),
    "step of 4 ms": setting(time_step=4e-3),
    "1 µm along x": setting(*moved(x=1e-6)),
    "10 µrad about z": setting(*moved(yaw=1e-5)),
    "world scale 10": setting("world_scale=10"),
    "world scale 40": setting("world_scale=40"),
}
PLACED: Mapping[str, Setting] = {
    "2° about z": setting(*moved(yaw=0.035)),
    "3 mm and 5° off": setting(*moved(x=3e-3, y=-2e-3, yaw=0.087)),
}
FLAT: Mapping[str, Setting] = {
    "flat palm, 2 ms": setting(*FLAT_PALM),
    "flat palm, 1 ms": setting(*FLAT_PALM, time_step=1e-3),
    "flat palm, 4 ms": setting(*FLAT_PALM, time_step=4e-3),
    "flat palm, 1 µm along y": setting(*FLAT_PALM, *moved(y=1e-6)),
    "flat palm, world scale 40": setting(*FLAT_PALM, "world_scale=40"),
}


def run_all(processes: int | None = None) -> dict[str, Turn]:
    """Run all of the above, by name."""
    settings = {**SAME, **PLACED, **FLAT}
    return dict(zip(settings, turns(list(settings.values()), processes), strict=True))


def apart(runs: Sequence[Turn]) -> float | None:
    """Return when two of the runs first differ by more than a degree [s], None if never."""
    times = np.arange(0, min(run.times[-1] for run in runs), 0.1)
    yaw = np.array([np.interp(times, run.times, run.yaw) for run in runs])
    found = times[np.ptp(yaw, axis=0) > APART]
    return float(found[0]) if len(found) else None


def table(runs: Mapping[str, Turn]) -> Iterator[str]:
    """Yield the table of all runs."""
    yield "run                        turned [°]  a cycle [°]  least  most  drift [mm]  tilt [°]"
    for name, run in runs.items():
        ends = f"{run.ends[-1]:10.1f}{run.per_cycle:13.2f}"
        ends += f"{run.cycles.min():7.1f}{run.cycles.max():6.1f}"
        yield f"{name:26} {ends}{1e3 * run.drift:12.2f}{run.tilt.max():10.2f}"


def together(what: str, runs: Sequence[Turn]) -> str:
    """Return what runs have in common in a sentence."""
    ends = np.array([run.ends[-1] for run in runs])
    when = apart(runs)
    away = "never" if when is None else f"from {when:.1f} s on"
    return (
        f"{what}: {ends.mean():.1f} ± {ends.std(ddof=1):.1f} ° (standard deviation), "
        f"{ends.min():.1f} to {ends.max():.1f}; more than {APART:g} ° apart {away}"
    )


def checked(runs: Mapping[str, Turn]) -> Iterator[str]:
    """Yield what groups of runs have in common, and how far the real hand turned the cube."""
    for what, group in (("numerics", SAME), ("placed otherwise", PLACED), ("flat palm", FLAT)):
        yield together(what, [runs[name] for name in group])
    turned = runs["step of 1 ms, as shipped"].ends[-1]
    off = 100 * (turned / MEASURED - 1)
    yield f"the real hand, in {CYCLES} cycles: {MEASURED:.0f} °; as shipped {off:+.1f} %"
    yield f"SoMo's simulation: {SOMO:.0f} °, {100 * (SOMO / MEASURED - 1):+.1f} %"


def study(pictures: Path | None) -> None:
    """Print the tables; draw the figure into a folder, if given."""
    print(f"{SCENE}, {SECONDS:g} s at {1e3 * STEP:g} ms unless said otherwise", flush=True)
    runs = run_all()
    print(*table(runs), *checked(runs), sep="\n", flush=True)
    found = run_open()
    print(*found.table(), sep="\n")
    if pictures is not None:
        groups = [[runs[name] for name in group] for group in ({**SAME, **PLACED}, FLAT)]
        draw(pictures / "in_hand.png", groups[0], groups[1], MEASURED / CYCLES, found.rates())
