"""The work-precision diagram: tip error against run time, with a curve for each integrator."""

from __future__ import annotations

import io
from typing import Any

from somo_cli.analysis.choice import RatedCase, rated_cases
from somo_cli.analysis.study_model import Study, StudyCase
from somo_cli.problems import ExtraMissing

MARKERS = "osD^vP"
STYLES = ("--", ":", "-.")
FORMATS = ("png", "svg")


def draw(study: Study, title: str) -> dict[str, bytes]:
    """Return the diagram of a study in every format, with the same bytes for the same numbers.

    Points of the first chain are labelled with their time steps, curves with their numbers of
    segments. Horizontal lines show the error of the reference and, if known, that of the chain
    against the continuum; a vertical line shows real time, if that is within the axes. Raises
    ExtraMissing.
    """
    try:
        from matplotlib import style
    except ImportError as error:
        raise ExtraMissing("the picture needs matplotlib: pip install 'somo-cli[plot]'") from error
    # the user's own style must not change the picture, nor may ids change from run to run
    with style.context(["default", {"svg.hashsalt": "somo"}]):
        figure = _figure(study, title)
        return {kind: _bytes(figure, kind) for kind in FORMATS}


def _figure(study: Study, title: str) -> Any:
    # Figure itself, not pyplot: no display, no state shared with others
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 5.0), layout="constrained")
    axes = figure.add_subplot()
    for number, (name, curve) in enumerate(_curves(study).items()):
        times, errors = zip(*((one.case.run_time, one.tip) for one in curve), strict=True)
        axes.loglog(times, errors, marker=MARKERS[number % len(MARKERS)], label=name)
        # curves of other numbers of segments are close, so that their labels would overlap
        for one in curve if curve[0].discretization is study.discretizations[0] else ():
            axes.annotate(
                f"{1e3 * one.case.time_step:.3g} ms",
                (one.case.run_time, one.tip),
                textcoords="offset points",
                xytext=(6, 4),
                fontsize=7,
                color="0.35",
            )
    axes.margins(x=0.15)  # room for the labels
    duration = study.settings.instants.duration
    low, high = axes.get_xlim()
    if low < duration < high:
        axes.axvline(duration, color="0.75", linewidth=1, label="real time")
    for number, (name, error) in enumerate(_lines(study).items()):
        style = STYLES[number % len(STYLES)]
        axes.axhline(error, linestyle=style, color="0.4", linewidth=1, label=name)
    axes.set_xlabel(f"run time of the stepping loop for {duration:g} s [s]")
    axes.set_ylabel("largest error of the tip, relative to length")
    axes.set_title(title)
    axes.grid(visible=True, which="both", linewidth=0.3, color="0.85")
    axes.legend(fontsize=8)
    return figure


def _curves(study: Study) -> dict[str, list[RatedCase]]:
    """Return the cases with a known error, by integrator and number of segments."""
    found: dict[str, list[RatedCase]] = {}
    for one in sorted(rated_cases(study), key=lambda one: -one.case.time_step):
        if one.case.errors["tip_position"] is not None:
            found.setdefault(_name(one.case), []).append(one)
    return dict(sorted(found.items(), key=lambda item: _place(study, item[1][0].case)))


def _name(case: StudyCase) -> str:
    of_segments = "" if case.segments is None else f", {case.segments} segments"
    return case.integrator + of_segments


def _place(study: Study, case: StudyCase) -> int:
    return [_name(other) for other in study.cases].index(_name(case))


def _lines(study: Study) -> dict[str, float]:
    lines: dict[str, float] = {}
    for discretization in study.discretizations:
        of_segments = (
            "" if discretization.segments is None else f", {discretization.segments} segments"
        )
        if discretization.model is not None:
            lines[f"error of the chain{of_segments}"] = (
                discretization.model.maximum / discretization.length
            )
    errors = [
        discretization.reference.error["tip_position"] / discretization.length
        for discretization in study.discretizations
    ]
    lines["error of the reference"] = max(errors)
    return lines


def _bytes(figure: Any, kind: str) -> bytes:
    stream = io.BytesIO()
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    figure.savefig(stream, format=kind, dpi=150, metadata=metadata)
    return stream.getvalue()
