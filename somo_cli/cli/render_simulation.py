"""The simulations of somo render: of a scene, or of the scene of a CSV that lacks columns."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from somo_cli import terminal
from somo_cli.budget import Budget
from somo_cli.cli import render_source, run_report
from somo_cli.cli.render_timing import Timing

if TYPE_CHECKING:
    from somo_cli.document.parse import Document
    from somo_cli.picture.recorded_motion import RecordedMotion
    from somo_cli.scene.model import Scene


def simulated_again(
    timing: Timing, budget: Budget, document: Document, recording: RecordedMotion
) -> RecordedMotion:
    """Simulate a recorded scene up to what is shown, with the rows of the recording or a film."""
    times, scene = recording.times, recording.scene
    (*_, end) = timing.frame_times(recording)
    rows = times[1] - times[0] if len(times) > 1 else None
    spacing = timing.between if timing.is_film else rows
    return render_source.simulated(document, scene, round(end / scene.time_step), budget, spacing)[
        0
    ]


def simulated_for(
    document: Document, scene: Scene, timing: Timing, budget: Budget
) -> tuple[RecordedMotion, tuple[float, ...]]:
    """Simulate a scene up to what is shown; return its recording and the times of the pictures."""
    steps = timing.steps_of(scene)
    spacing = timing.between if timing.is_film else None
    recording, summary = render_source.simulated(document, scene, steps, budget, spacing)
    terminal.print_lines(run_report.finding_lines(summary))
    why = ""
    if summary.stopped is not None:
        why = f", by stop[{summary.stopped.condition}]: {summary.stopped.reason}"
        if timing.is_film and summary.steps < steps:
            terminal.print_message(f"the film ends at {recording.times[-1]:.9g} s{why}")
            timing = dataclasses.replace(timing, until=None)
    return recording, timing.frame_times(recording, why)
