"""When the pictures of somo render are taken, as options say it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from somo_cli.cli.application import require

if TYPE_CHECKING:
    from fractions import Fraction

    from somo_cli.picture.recorded_motion import RecordedMotion
    from somo_cli.scene.model import Scene

MAX_TIME = 1e6  # s
MAX_PICTURES = 20_000


@dataclass(frozen=True, slots=True)
class Timing:
    """The options, None where they are not given: times in seconds, and `steps` of a scene."""

    is_film: bool
    at: float | None
    start: float | None
    until: float | None
    steps: int | None
    every: float | None
    speed: float

    def refuse_misuse(self, is_recording: bool) -> None:
        """End with wrong usage of options that do not go together, or are out of bounds."""
        require(self.at is None or not self.is_film, "--at", "it is for a still, which is a .png")
        given = {"--from": self.start, "--until": self.until, "--every": self.every}
        for option, value in given.items():
            needs = "it is for a film, which is an .mp4 or a .gif"
            require(value is None or self.is_film, option, needs)
        for option, value in {"--at": self.at, **given}.items():
            is_time = value is None or 0 <= value <= MAX_TIME
            require(is_time, option, f"{value} s is not from 0 to {MAX_TIME:g}")
        require(self.every != 0, "--every", "pictures cannot be 0 s apart")
        is_speed = 0 < self.speed <= MAX_TIME
        require(is_speed, "--speed", f"{self.speed} is not greater than 0 and at most {MAX_TIME:g}")
        for_scenes = "it is for a scene, and this is a CSV"
        require(self.steps is None or not is_recording, "--steps", for_scenes)
        other = "--at" if self.at is not None else "--until"
        is_one = self.steps is None or (self.at is None and self.until is None)
        require(is_one, "--steps", f"it says the end, and so does {other}")

    @property
    def between(self) -> float:
        """The time between two pictures of a film [s]."""
        from somo_cli.picture.frame_times import DEFAULT_FRAME_RATE

        return self.speed / DEFAULT_FRAME_RATE if self.every is None else self.every

    @property
    def rate(self) -> Fraction:
        """The pictures of a film in a second of its own."""
        from somo_cli.picture.film import MAX_GIF_RATE
        from somo_cli.picture.frame_times import rate_of

        rate = rate_of(self.between, self.speed)
        message = f"the film would show {float(rate):g} pictures in a second: it can be 1 to"
        require(
            1 <= rate <= MAX_GIF_RATE, "--every", f"{message} {MAX_GIF_RATE}, that is speed / every"
        )
        return rate

    def steps_of(self, scene: Scene) -> int:
        """Return how many steps of a scene have to be simulated."""
        from somo_cli.scene.stop_conditions import StopAtTime

        if self.steps is not None:
            return self.steps
        end = self.until if self.is_film else self.at or 0.0
        if end is None:
            times = [stop.time for stop in scene.stop_conditions if isinstance(stop, StopAtTime)]
            require(bool(times), "--until", "say when the film ends, here or by --steps")
            end = min(times)
        return round(end / scene.time_step)

    def frame_times(self, recording: RecordedMotion, why: str = "") -> tuple[float, ...]:
        """Return the times of the pictures [s]; `why` a recording ends where it does, if known."""
        from somo_cli.picture.frame_times import times_of

        first, last = recording.times[0], recording.times[-1]
        given = (("--at", self.at), ("--from", self.start), ("--until", self.until))
        slack = recording.scene.time_step / 2 * (1 + 1e-6)  # times of a scene fall on its steps
        for option, value in given:
            if value is not None:
                late = f"{value:g} s is beyond the end, {last:.9g} s{why}"
                require(value <= last + slack, option, late)
                require(value >= first - slack, option, f"{value:g} s is before {first:.9g} s")
        if not self.is_film:
            return (last if self.at is None else min(max(self.at, first), last),)
        start = first if self.start is None else max(self.start, first)
        end = last if self.until is None else min(self.until, last)
        require(start <= end, "--from", f"{start:g} s is behind the end, {end:.9g} s")
        count = (end - start) / self.between + 1
        many = f"{count:.0f} pictures are more than {MAX_PICTURES}"
        require(count <= MAX_PICTURES, "--every", many)
        return times_of(start, end, self.between)
