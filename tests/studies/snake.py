"""The snake crawls: its speed against frequency and amplitude of its wave, held against theory.

SoMoGym's SnakeLocomotionDiscrete, but with a belly whose friction is the same whatever the
heading of the snake, with the masses and stiffness of silicone, and with a second opinion:
`planar_snake`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from somo_cli.arrays import Array
from somo_cli.loading import load
from somo_cli.manipulator.compile import compile_definition
from tests.builders.scenes import DEFINITIONS
from tests.studies import drawing
from tests.studies.planar_snake import Gait, PlanarSnake
from tests.studies.running import Record, Setting, recorded_all

SCENE = "crawler_scene.yaml"
GAIT = Gait(amplitude=0.6, frequency=1.0, lag=math.pi / 4, friction=0.5, along=0.1)
"""What the scene itself says."""

FREQUENCIES = (0.5, 1.0, 2.0, 3.0, 4.0)  # Hz
AMPLITUDES = (0.2, 0.4, 0.6, 0.8, 1.0)  # N·m
SECONDS = 4.0
WINDOW = 2.0  # s: the last ones, whole periods of all frequencies

_ENTRY = "manipulators[0].actuation[0].wave"
_SURFACE = "manipulators[0].surface"
HARD = (f'{_SURFACE}={{"friction": 0.5, "anisotropic_friction": [1, 1, 0.1]}}',)
THIN = (
    "manipulators[0].position=[-0.4, 0, 0.003]",
    *(
        f"manipulators[0].definition.actuator_definitions[{number}].link_definition.dimensions="
        "[0.006, 0.04, 0.05]"
        for number in range(8)
    ),
)
"""A fifth as thick: its centre of mass, where inertia acts, is so much nearer to the friction."""
EQUAL = (f"{_SURFACE}.anisotropic_friction=[1, 1, 1]",)


@dataclass(frozen=True, slots=True)
class Crawl:
    """A run of the snake: its gait, time step [s], length [s], and what else is set."""

    gait: Gait = GAIT
    step: float = 1e-3
    seconds: float = 2.0
    sets: tuple[str, ...] = ()
    phase: float = 0.0

    @property
    def setting(self) -> Setting:
        """What to run: with every link's place, 200 times a second."""
        gait = self.gait
        wave = {"amplitude": gait.amplitude, "frequency": gait.frequency, "lag": gait.lag}
        sets = [f"{_ENTRY}.{name}={value!r}" for name, value in wave.items()]
        sets += [f"{_ENTRY}.phase={self.phase!r}", "record.columns=[link_positions]"]
        sets += ["record.every=5"]
        return Setting(SCENE, self.seconds, (*sets, *self.sets), self.step)


def snake() -> PlanarSnake:
    """Return the second opinion on the shipped snake."""
    path = str(DEFINITIONS / "crawler.yaml")
    return PlanarSnake(compile_definition(load(path)).chain)


def mirrored(crawl: Crawl) -> Crawl:
    """Return the same crawl seen from the other side of the snake: its wave comes from the tip.

    The last of eight actuators then starts where the first one did.
    """
    gait = crawl.gait
    return replace(crawl, gait=replace(gait, lag=-gait.lag), phase=-7 * gait.lag)


def links(record: Record) -> Array:
    """Return where the links' frames are, shape (2, links, rows) [m]."""
    return np.array(
        [
            [record[name] for name in record.columns if name.endswith(f".{axis}_m")]
            for axis in ("x", "y")
        ]
    )


def centre(record: Record, masses: Array, lengths: Array) -> Array:
    """Return the centre of mass over time, shape (2, rows) [m].

    The middle of a link is half its length ahead of its frame, towards the next one; a last link,
    which is half as long as the others, goes on as the one before it.
    """
    frames = links(record)
    ahead = np.diff(frames, axis=1)
    ahead = np.concatenate([ahead, ahead[:, -1:] * lengths[-1] / lengths[-2]], axis=1)
    middles = frames + ahead / 2
    found: Array = np.einsum("i,dit->dt", masses / masses.sum(), middles)
    return found


def speed(times: Array, places: Array, window: float) -> float:
    """Return how far a place has gone in the last `window` seconds, over that time [m/s]."""
    first = int(np.argmin(np.abs(times - (times[-1] - window))))
    crawled = places[:, -1] - places[:, first]
    return float(np.hypot(*crawled) / (times[-1] - times[first]))


def speeds(crawls: Sequence[Crawl], window: float, processes: int | None = None) -> list[float]:
    """Return the speed of each run in its last `window` seconds [m/s]."""
    model = snake()
    runs = recorded_all([crawl.setting for crawl in crawls], processes)
    return [speed(run["time_s"], centre(run, model.masses, model.lengths), window) for run in runs]


def opinions(crawls: Iterable[Crawl], window: float) -> list[float]:
    """Return the same of the second opinion."""
    model = snake()
    found = []
    for crawl in crawls:
        times = np.unique([0.0, crawl.seconds - window, crawl.seconds])
        found.append(speed(times, model.centres(crawl.gait, times), window))
    return found


def study(pictures: Path | None) -> None:
    """Print speeds against step, scale, belly, frequency and amplitude; draw the latter two."""
    _print_convergence()
    waves = [replace(GAIT, frequency=frequency) for frequency in FREQUENCIES]
    waves += [replace(GAIT, amplitude=amplitude) for amplitude in AMPLITUDES]
    crawls = [Crawl(gait, 2e-3, SECONDS) for gait in dict.fromkeys(waves)]
    each = zip(speeds(crawls, WINDOW), opinions(crawls, WINDOW), strict=True)
    pairs = dict(zip(dict.fromkeys(waves), each, strict=True))
    found, reported = zip(*(pairs[gait] for gait in waves), strict=True)
    print(f"\nmean speed over the last {WINDOW:g} s of {SECONDS:g} s, 2 ms [m/s]")
    print("amplitude [N m]  frequency [Hz]    speed  second opinion      off")
    for gait, one, other in zip(waves, found, reported, strict=True):
        wave = f"{gait.amplitude:15g}{gait.frequency:16g}"
        print(f"{wave}{one:9.4f}{other:16.4f}{one / other - 1:+9.1%}")
    if pictures is not None:
        _draw(pictures, found, reported)


def _print_convergence() -> None:
    cases = {
        "scene as it is, 1 ms": Crawl(),
        "2 ms": Crawl(step=2e-3),
        "0.5 ms": Crawl(step=5e-4),
        "world scale 10": Crawl(sets=("world_scale=10",)),
        "world scale 40": Crawl(sets=("world_scale=40",)),
        "belly ten times as stiff": Crawl(
            sets=(f"{_SURFACE}.contact_stiffness=15000", f"{_SURFACE}.contact_damping=30")
        ),
        "wave from the tip, mirrored": mirrored(Crawl()),
        "a fifth as thick, 2 ms": Crawl(step=2e-3, sets=THIN),
        "a fifth as thick, 1 ms": Crawl(sets=THIN),
        "hard belly, 2 ms": Crawl(step=2e-3, sets=HARD),
        "hard belly, 1 ms": Crawl(sets=HARD),
        "equal friction, 2 ms": Crawl(step=2e-3, sets=EQUAL),
    }
    (reported,) = opinions([Crawl()], 1.0)
    print(f"speed in the second period of 1 s; {reported:.4f} m/s by the second opinion")
    for name, found in zip(cases, speeds(list(cases.values()), 1.0), strict=True):
        print(f"{name:30}{found:8.4f} m/s{found / reported - 1:+9.2%}")


def _draw(pictures: Path, found: Sequence[float], reported: Sequence[float]) -> None:
    figure = drawing.new_figure()
    grid = figure.add_gridspec(2, 2)
    _draw_path(figure.add_subplot(grid[0, :]))
    count = len(FREQUENCIES)
    sweeps = (
        (FREQUENCIES, slice(0, count), "frequency of the wave [Hz], 0.6 N m"),
        (AMPLITUDES, slice(count, None), "amplitude of the wave [N m], 1 Hz"),
    )
    for column, (values, part, label) in enumerate(sweeps):
        axes = figure.add_subplot(grid[1, column])
        axes.plot(values, reported[part], color="0.5", label="second opinion")
        axes.plot(values, found[part], "o", color="tab:green", label="somo, 2 ms")
        axes.set_ylim(0)
        drawing.panel(axes, label, "speed [m/s]")
    axes.legend(fontsize=8)
    drawing.save(figure, pictures / "snake.png")


def _draw_path(axes: Any) -> None:
    model = snake()
    (run,) = recorded_all([Crawl(step=2e-3, seconds=SECONDS).setting])
    frames, times = links(run), run["time_s"]
    for second in range(5):
        row = int(np.argmin(np.abs(times - second)))
        shade = str(0.8 - 0.2 * second)
        axes.plot(*frames[:, :, row], color=shade, linewidth=3, label=f"{second} s")
    axes.plot(*centre(run, model.masses, model.lengths), color="tab:red", linewidth=1)
    axes.set_aspect("equal")
    axes.legend(fontsize=7, ncols=5, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    drawing.panel(axes, "x [m]", "y [m]")
