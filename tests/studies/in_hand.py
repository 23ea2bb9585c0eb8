"""In-hand manipulation: how far four soft fingers turn a cube, how surely, and on what it depends.

Ten runs that differ by micrometres at the start, in the step or in the world scale show what can be
said at all; runs with other friction, stiffness and torque show what is open as long as those are
not measured.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from somo_cli.simulation.springs import Array
from tests.studies.in_hand_pictures import draw
from tests.studies.in_hand_turn import (
    CYCLES,
    FINGERS,
    FRICTION,
    SCENE,
    SECONDS,
    SIDE,
    SIDE_STIFFNESS,
    STIFFNESS,
    TORQUE,
    Turn,
    friction_of_fingers,
    joint,
    moved,
    setting,
    side_torque,
    turns,
)
from tests.studies.running import Setting

# °, in ten cycles, of the real hand and of SoMo's simulation of it: plot_fingergait.ipynb in
# examples/design_studies/ihm_fingergait of github.com/GrauleM/somo
MEASURED, SOMO = 536.0, 583.0
APART = 1.0  # °

PERTURBED: Mapping[str, Setting] = {
    "as shipped": setting(),
    "1 µm along x": setting(*moved(x=1e-6)),
    "-1 µm along x": setting(*moved(x=-1e-6)),
    "1 µm along y": setting(*moved(y=1e-6)),
    "10 µm along x": setting(*moved(x=1e-5)),
    "10 µrad about z": setting(*moved(yaw=1e-5)),
    "step of 2 ms": setting(time_step=2e-3),
    "step of 0.5 ms": setting(time_step=5e-4),
    "world scale 10": setting("world_scale=10"),
    "world scale 40": setting("world_scale=40"),
}

OPEN_CYCLES, OPEN_STEP = 6, 2e-3  # s: of the runs about what is open

# by name, and by the value over that of the scene
OPEN: Mapping[str, Mapping[float, Sequence[str]]] = {
    "torque aside": {part: side_torque(part * SIDE) for part in (0.7, 1.3)},
    "friction of fingers": {
        part: friction_of_fingers(part * FRICTION) for part in (0.5, 0.75, 1.5, 3.0)
    },
    "friction of palm": {part: (f"objects[0].friction={0.15 * part!r}",) for part in (0.5, 2.0)},
    "torque per pressure": {
        part: joint(0, "torque_per_pressure", part * TORQUE) for part in (0.8, 1.2)
    },
    "stiffness inwards": {
        part: joint(0, "spring_stiffness", part * STIFFNESS) for part in (0.8, 1.2)
    },
    "stiffness aside": {
        part: joint(1, "spring_stiffness", part * SIDE_STIFFNESS) for part in (0.8, 1.2)
    },
    "damping": {
        3.0: (*joint(0, "spring_damping", 0.00135), *joint(1, "spring_damping", 0.00216)),
    },
    "mass of cube": {5.0: ("objects[1].mass=0.05",)},
}

# what has no such factor
OTHER: Mapping[str, Sequence[str]] = {
    "palm 3 mm higher": ("objects[0].position=[0, 0, 0.083]",),
    "palm 3 mm lower": ("objects[0].position=[0, 0, 0.077]",),
    # as a patch of contact of 4.5 mm would have: 2/3 of its radius
    "fingers' spinning friction 3 mm": tuple(
        f"{finger}.surface.spinning_friction=0.003" for finger in FINGERS
    ),
}


def apart(runs: Sequence[Turn]) -> float:
    """Return when two of the runs first differ by more than a degree [s]."""
    times = np.arange(0, min(run.times[-1] for run in runs), 0.1)
    yaw = np.array([np.interp(times, run.times, run.yaw) for run in runs])
    return float(times[np.ptp(yaw, axis=0) > APART][0])


def totals(runs: Sequence[Turn]) -> Array:
    """Return how far the cube has turned after the last cycle in each run [°]."""
    return np.array([run.ends[-1] for run in runs])


def perturbed(runs: Mapping[str, Turn]) -> Iterator[str]:
    """Yield the table of runs that differ by next to nothing, and what they have in common."""
    yield "run              turned [°]  a cycle [°]  least  most  drift [mm]  rise [mm]  tilt [°]"
    for name, run in runs.items():
        ends = f"{run.ends[-1]:10.1f}{run.per_cycle:13.1f}"
        ends += f"{run.cycles.min():7.0f}{run.cycles.max():6.0f}"
        off = f"{1e3 * run.drift:12.1f}{1e3 * run.rise:11.1f}{run.tilt.max():10.1f}"
        yield f"{name:16} {ends}{off}"
    every = totals(list(runs.values()))
    mean, spread = every.mean(), every.std(ddof=1)
    cycles = np.concatenate([run.cycles for run in runs.values()])
    yield f"in {CYCLES} cycles {mean:.0f} ± {spread:.0f} ° (standard deviation over runs)"
    yield f"single cycles {cycles.mean():.1f} ± {cycles.std(ddof=1):.1f} °"
    yield f"runs are more than {APART:g} ° apart from {apart(list(runs.values())):.1f} s on"
    yield f"the real hand: {MEASURED:.0f} °, model {100 * (mean / MEASURED - 1):+.0f} %"
    yield f"SoMo's simulation: {SOMO:.0f} °"


def opened(base: float, found: Mapping[tuple[str, float | None], Turn]) -> Iterator[str]:
    """Yield the table of what the turn depends on; `base` is that of the scene, a cycle [°]."""
    yield f"{OPEN_CYCLES} cycles at {1e3 * OPEN_STEP:g} ms; factors are on the scene's value"
    yield "changed                          factor  a cycle [°]  of the scene's"
    for (name, part), run in found.items():
        factor = "-" if part is None else f"{part:g}"
        lost = "" if len(run.cycles) == OPEN_CYCLES else f"  lost after {run.times[-1]:.1f} s"
        change = 100 * (run.per_cycle / base - 1)
        yield f"{name:33}{factor:>6}{run.per_cycle:13.1f}{change:+14.0f} %{lost}"


def run_perturbed(processes: int | None = None) -> dict[str, Turn]:
    """Run the scene ten times, nearly the same."""
    return dict(zip(PERTURBED, turns(list(PERTURBED.values()), processes), strict=True))


def run_open(processes: int | None = None) -> dict[tuple[str, float | None], Turn]:
    """Run the scene with other values of what is open, by name and factor."""
    changes: dict[tuple[str, float | None], Sequence[str]] = {
        (name, part): sets for name, parts in OPEN.items() for part, sets in parts.items()
    }
    changes |= {(name, None): sets for name, sets in OTHER.items()}
    settings = [
        setting(*sets, cycles=OPEN_CYCLES, time_step=OPEN_STEP) for sets in changes.values()
    ]
    return dict(zip(changes, turns(settings, processes), strict=True))


def study(pictures: Path | None) -> None:
    """Print the tables; draw the figure if told where to."""
    print(f"{SCENE}, {SECONDS:g} s at 1 ms, world scale 20, unless said otherwise", flush=True)
    runs = run_perturbed()
    print(*perturbed(runs), sep="\n", flush=True)
    base = float(np.mean([run.cycles[:OPEN_CYCLES].mean() for run in runs.values()]))
    found = run_open()
    print(*opened(base, found), sep="\n")
    if pictures is not None:
        rates: dict[str, dict[float, float]] = {}
        for (name, part), run in found.items():
            if part is not None:
                rates.setdefault(name, {1.0: base})[part] = run.per_cycle
        draw(pictures / "in_hand.png", list(runs.values()), MEASURED / CYCLES, rates)
