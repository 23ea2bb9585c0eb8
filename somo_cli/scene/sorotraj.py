"""Read trajectories of several channels in the format of sorotraj 0.9, as one list of knots.

A file has a main part, and may have a prefix before it and a suffix after it. The times of each
part start at zero. The main part has knots (`direct`, or `interp` with `none` or `linear`), samples
of a periodic spline through knots (`cubic`), or samples of a waveform. Values are linear between
knots and constant after the last one.

Source: github.com/harvard-microrobotics/sorotraj, build_traj.py and interpolator.py of version 0.9.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from somo_cli.scene import signals

Knots = list[tuple[float, tuple[float, ...]]]

SAMPLED_WAVEFORMS = ("square-sampled", "sin", "cos-up", "cos-down")
"""The waveforms that sorotraj samples, `subsample_num` times in all cycles together."""


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Knots with strictly increasing times [s], each with one value per channel."""

    times: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]

    def weighted_sum(self, weights: Sequence[float]) -> tuple[tuple[float, float], ...]:
        """Return (time [s], value) pairs of the weighted sum of the channels."""
        return tuple(
            (time, math.fsum(w * v for w, v in zip(weights, values, strict=True)))
            for time, values in zip(self.times, self.values, strict=True)
        )


def read_trajectory(
    data: Mapping[str, Any],
    repetitions: int = 1,
    speed_factor: float = 1.0,
    invert: bool | Sequence[int] = False,
) -> Trajectory:
    """Return the complete trajectory of a file without errors.

    The main part runs `repetitions` times, `speed_factor` times as fast; repetitions skip its first
    knot. `invert` changes the sign of all channels, or of the channels that it lists.
    """
    setpoints = data["config"].get("setpoints") or {}
    prefix, suffix = (_read_knots(setpoints.get(part) or []) for part in ("prefix", "suffix"))
    main = _repeated(main_part_knots(data), repetitions)
    start = prefix[-1][0] if prefix else 0.0
    knots = prefix + [(start + time / speed_factor, values) for time, values in main]
    end = knots[-1][0]
    knots += [(end + time, values) for time, values in suffix]
    return _strictly_increasing(_inverted(knots, invert))


def _repeated(knots: Knots, repetitions: int) -> Knots:
    # as in sorotraj 0.9: the period starts at time zero, even if the first knot is later
    period = knots[-1][0]
    repeated = [knots[0]]
    for number in range(repetitions):
        repeated += [(time + number * period, values) for time, values in knots[1:]]
    return repeated


def _inverted(knots: Knots, invert: bool | Sequence[int]) -> Knots:
    """Return the knots with the sign changed in all channels, or in those that `invert` lists."""
    signs = [1.0] * len(knots[0][1])
    for channel in range(len(signs)) if invert is True else invert or ():
        signs[channel] = -1.0
    return [
        (time, tuple(sign * value for sign, value in zip(signs, values, strict=True)))
        for time, values in knots
    ]


def _strictly_increasing(knots: Knots) -> Trajectory:
    """Return the knots as a trajectory with strictly increasing times.

    Two knots may have the same time where two parts meet. If their values are equal, one knot is
    dropped; if not, the second gets the next larger float as its time, which makes a jump.
    """
    times: list[float] = []
    values: list[tuple[float, ...]] = []
    for time, row in knots:
        if not times or time > times[-1]:
            times.append(time)
            values.append(row)
        elif row == values[-1]:
            continue
        elif times[-1] == 0.0:
            # a part with one knot at time zero takes no time: the next part replaces it
            values[-1] = row
        else:
            times.append(math.nextafter(times[-1], math.inf))
            values.append(row)
    return Trajectory(tuple(times), tuple(values))


def main_part_knots(data: Mapping[str, Any]) -> Knots:
    """Return the knots of the main part of a file without errors; times start at zero [s]."""
    config = data["config"]
    kind = data["settings"]["traj_type"]
    if kind == "waveform":
        return _waveform_knots(config)
    knots = _read_knots(config["setpoints"]["main"])
    if kind == "interp" and config.get("interp_type") == "cubic":
        return _cubic_knots(knots, int(config["subsample_num"]))
    # sorotraj samples straight lines too, but the samples lie on the lines
    return knots


def _read_knots(rows: Sequence[Sequence[float]]) -> Knots:
    return [(float(row[0]), tuple(map(float, row[1:]))) for row in rows]


def _cubic_knots(knots: Knots, samples: int) -> Knots:
    first, last = knots[0][0], knots[-1][0]
    times = [first + (last - first) * number / samples for number in range(samples + 1)]
    for time, _ in knots:
        nearest = min(range(samples + 1), key=lambda number: abs(times[number] - time))
        times[nearest] = time
    splines = [
        signals.piecewise_signal(
            [(time - first, row[channel]) for time, row in knots], "cubic", True
        )
        for channel in range(len(knots[0][1]))
    ]
    # a signal at the end of its period returns the first value, which equals the last
    return [(time, tuple(spline.at(time - first) for spline in splines)) for time in times]


def _waveform_knots(config: Mapping[str, Any]) -> Knots:
    cycles, frequency = int(config["num_cycles"]), float(config["waveform_freq"])
    rows = zip(config["waveform_max"], config["waveform_min"], config["channels"], strict=True)
    scales = [((most - least) / 2 * on, (most + least) / 2 * on) for most, least, on in rows]
    shape = config["waveform_type"]
    if shape in SAMPLED_WAVEFORMS:
        samples = int(config["subsample_num"])
        turns = [cycles * number / samples for number in range(samples + 1)]
        points = [(turn, _WAVEFORM_FUNCTIONS[shape](turn)) for turn in turns]
    else:
        points = [
            (n + turn, level) for n in range(cycles) for turn, level in _WAVEFORM_CORNERS[shape]
        ]
        points.append((float(cycles), _WAVEFORM_CORNERS[shape][0][1]))
    return [
        (turn / frequency, tuple(offset + level * half for half, offset in scales))
        for turn, level in points
    ]


_WAVEFORM_FUNCTIONS = {
    "square-sampled": lambda turn: 1.0 if turn % 1.0 < 0.5 else -1.0,
    "sin": lambda turn: math.sin(2 * math.pi * turn),
    "cos-up": lambda turn: math.cos(2 * math.pi * turn),
    "cos-down": lambda turn: -math.cos(2 * math.pi * turn),
}

_WAVEFORM_CORNERS: Mapping[str, tuple[tuple[float, float], ...]] = {
    "square": ((0.0, -1.0), (0.49, -1.0), (0.5, 1.0), (0.99, 1.0)),
    "triangle": ((0.0, -1.0), (0.5, 1.0)),
    "sawtooth-f": ((0.0, -1.0), (0.99, 1.0)),
    "sawtooth-r": ((0.0, -1.0), (0.01, 1.0)),
}
