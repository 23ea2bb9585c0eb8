"""Trajectories of several channels in the format of sorotraj 0.9, as one list of knots.

A file has a main part, and may have a prefix before it and a suffix after it. The knots of each
part count time from the start of that part. The main part is given by its knots (`direct`, `interp`
with `none` or `linear`), or sampled from a periodic spline through them (`cubic`) or from a wave
form. Values are linear between knots, and constant after the last one.

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
"""Wave forms of which `subsample_num` samples are taken."""


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Knots with strictly increasing times [s], each with one value per channel."""

    times: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]

    def weighted_sum(self, weights: Sequence[float]) -> tuple[tuple[float, float], ...]:
        """Return (time, value) pairs of one sum of the channels, each times its weight."""
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
    """Return the whole trajectory of a file without errors.

    The main part comes `repetitions` times, faster by `speed_factor`; from the second time on it
    starts with its second knot. `invert` turns the sign of all channels, or of those it lists.
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
    # as in 0.9: the period counts from time zero, even if the first knot comes later
    period = knots[-1][0]
    repeated = [knots[0]]
    for number in range(repetitions):
        repeated += [(time + number * period, values) for time, values in knots[1:]]
    return repeated


def _inverted(knots: Knots, invert: bool | Sequence[int]) -> Knots:
    """Return the knots with the sign of all channels turned, or of those that `invert` lists."""
    signs = [1.0] * len(knots[0][1])
    for channel in range(len(signs)) if invert is True else invert or ():
        signs[channel] = -1.0
    return [
        (time, tuple(sign * value for sign, value in zip(signs, values, strict=True)))
        for time, values in knots
    ]


def _strictly_increasing(knots: Knots) -> Trajectory:
    """Return the knots as a trajectory; where two parts meet, their times may be equal.

    Of two equal knots one stays. Different values at one time become a jump to the next float.
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
            # a part with one knot at time zero takes no time: the next part begins at once
            values[-1] = row
        else:
            times.append(math.nextafter(times[-1], math.inf))
            values.append(row)
    return Trajectory(tuple(times), tuple(values))


def main_part_knots(data: Mapping[str, Any]) -> Knots:
    """Return the knots of the main part of a file without errors, in the time of that part."""
    config = data["config"]
    kind = data["settings"]["traj_type"]
    if kind == "waveform":
        return _waveform_knots(config)
    knots = _read_knots(config["setpoints"]["main"])
    if kind == "interp" and config.get("interp_type") == "cubic":
        return _cubic_knots(knots, int(config["subsample_num"]))
    # the samples that sorotraj takes of straight lines lie on them
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
    # the end of a period is the start of the next, where the values are the same
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
