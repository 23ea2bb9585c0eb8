"""Trajectories of several channels in the format of sorotraj 0.9, as one list of knots.

A file has a main part, and may have a prefix before it and a suffix after it; each counts its own
time. The main part is given by its knots (`direct`, `interp` with `none` or `linear`), sampled
from a periodic spline through them (`cubic`) or from a wave form. Between knots values are linear,
after the last one they are held. github.com/harvard-microrobotics/sorotraj, build_traj.py and
interpolator.py of version 0.9.
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
    """Return the whole trajectory of a sound file.

    The main part comes `repetitions` times, faster by `speed_factor`; from the second time on it
    starts with its second knot. `invert` turns the sign of all channels, or of those it lists.
    """
    config = data["config"]
    setpoints = config.get("setpoints") or {}
    prefix, suffix = (_read_knots(setpoints.get(part) or []) for part in ("prefix", "suffix"))
    main = main_part_knots(data)
    # as in 0.9: what is repeated counts from zero, whenever the first knot is
    period = main[-1][0]
    body = [main[0]]
    for number in range(repetitions):
        body += [(time + number * period, values) for time, values in main[1:]]
    start = prefix[-1][0] if prefix else 0.0
    whole = prefix + [(start + time / speed_factor, values) for time, values in body]
    end = whole[-1][0]
    whole += [(end + time, values) for time, values in suffix]
    signs = [1.0] * len(whole[0][1])
    for channel in range(len(signs)) if invert is True else invert or ():
        signs[channel] = -1.0
    times: list[float] = []
    values: list[tuple[float, ...]] = []
    for time, row in whole:
        signed = tuple(sign * value for sign, value in zip(signs, row, strict=True))
        if times and time <= times[-1]:
            if signed == values[-1]:
                continue
            if times[-1] == 0.0:
                # a part of one knot at time zero takes no time: the next part begins at once
                values[-1] = signed
                continue
            # two parts that meet with different values jump just after they meet
            time = math.nextafter(times[-1], math.inf)
        times.append(time)
        values.append(signed)
    return Trajectory(tuple(times), tuple(values))


def main_part_knots(data: Mapping[str, Any]) -> Knots:
    """Return the knots of the main part of a sound file, its own time."""
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
