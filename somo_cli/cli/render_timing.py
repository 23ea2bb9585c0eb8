"""Compute the times of the pictures of somo render from its options."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from somo_cli.cli.application import require, require_few_steps
from somo_cli.cli.simulated_time import check_time_options, steps_to_take

if TYPE_CHECKING:
    from fractions import Fraction

    from somo_cli.picture.recorded_motion import RecordedMotion
    from somo_cli.scene.model import Scene

MAX_TIME = 1e6  # s
MAX_PICTURES = 20_000


@dataclass(frozen=True, slots=True)
class Timing:
    """The options of time [s], and the time steps of a scene; None if not given."""

    is_film: bool
    at: float | None
    start: float | None
    until: float | None
    steps: str | None
    duration: float | None
    every: float | None
    speed: float

    def check_options(self, is_recording: bool) -> None:
        """Exit with a usage error for options that exclude each other, or are out of bounds."""
        require(self.at is None or not self.is_film, "--at", "it is for a still, a .png")
        given = {"--from": self.start, "--until": self.until, "--every": self.every}
        for option, value in given.items():
            needs = "it is for a film, an .mp4 or a .gif"
            require(value is None or self.is_film, option, needs)
        for option, value in {"--at": self.at, **given}.items():
            is_time = value is None or 0 <= value <= MAX_TIME
            require(is_time, option, f"{value} s is not from 0 to {MAX_TIME:g}")
        require(self.every != 0, "--every", "pictures cannot be 0 s apart")
        is_speed = 0 < self.speed <= MAX_TIME
        require(is_speed, "--speed", f"{self.speed} is not greater than 0 and at most {MAX_TIME:g}")
        for_scenes = "it is for a scene, and this is a CSV"
        other = "--at" if self.at is not None else "--until"
        has_end = self.at is not None or self.until is not None
        for option, given_time in (("--steps", self.steps), ("--duration", self.duration)):
            require(given_time is None or not is_recording, option, for_scenes)
            require(given_time is None or not has_end, option, f"it excludes {other}")
        check_time_options(self.steps, self.duration)

    @property
    def between(self) -> float:
        """The time between two pictures of a film [s]."""
        from somo_cli.picture.frame_times import DEFAULT_FRAME_RATE

        return self.speed / DEFAULT_FRAME_RATE if self.every is None else self.every

    @property
    def rate(self) -> Fraction:
        """The frame rate of a film [1/s]."""
        from somo_cli.picture.film import MAX_GIF_RATE
        from somo_cli.picture.frame_times import rate_of

        rate = rate_of(self.between, self.speed)
        message = f"a frame rate of {float(rate):g} per second is not from 1 to {MAX_GIF_RATE}"
        is_rate = 1 <= rate <= MAX_GIF_RATE
        require(is_rate, "--every", f"{message}: the frame rate is speed / every")
        return rate

    def steps_of(self, scene: Scene) -> int:
        """Return the number of time steps to simulate."""
        from somo_cli.scene.stop_conditions import StopAtTime

        if self.steps is not None or self.duration is not None:
            return steps_to_take(self.steps, self.duration, scene)
        end = self.until if self.is_film else self.at or 0.0
        if end is None:
            times = [stop.time for stop in scene.stop_conditions if isinstance(stop, StopAtTime)]
            times += [] if scene.duration is None else [scene.duration]
            require(bool(times), "--until", "give the end of the film, here or by --duration")
            end = min(times)
        steps = end / scene.time_step
        require_few_steps(steps, "--until" if self.is_film else "--at")
        return round(steps)

    def frame_times(self, recording: RecordedMotion, why: str = "") -> tuple[float, ...]:
        """Return the times of the pictures [s]; `why` is the reason of an early end, if known."""
        from somo_cli.picture.frame_times import times_of

        first, last = recording.times[0], recording.times[-1]
        given = (("--at", self.at), ("--from", self.start), ("--until", self.until))
        slack = recording.scene.time_step / 2 * (1 + 1e-6)  # times are rounded to time steps
        for option, value in given:
            if value is not None:
                late = f"{value:g} s is after the end, {last:.9g} s{why}"
                require(value <= last + slack, option, late)
                require(value >= first - slack, option, f"{value:g} s is before {first:.9g} s")
        if not self.is_film:
            return (last if self.at is None else min(max(self.at, first), last),)
        start = first if self.start is None else max(self.start, first)
        end = last if self.until is None else min(self.until, last)
        require(start <= end, "--from", f"{start:g} s is after the end, {end:.9g} s")
        count = (end - start) / self.between + 1
        many = f"{count:.0f} pictures are more than {MAX_PICTURES}"
        require(count <= MAX_PICTURES, "--every", many)
        return times_of(start, end, self.between)
