"""The diagram: the same bytes for the same study, whatever the user's style, and what is in it."""

from __future__ import annotations

import dataclasses
import math
import re

import matplotlib
import numpy as np
import pytest

from somo_cli.analysis.common_instants import common_instants
from somo_cli.analysis.errors import ErrorSummary
from somo_cli.analysis.reference import Reference
from somo_cli.analysis.study_model import Discretization, Study, StudyCase, StudySettings
from somo_cli.picture.work_precision import draw
from tests.builders.scenes import scene_from_file


def study(segments: tuple[int | None, ...] = (None,), model: ErrorSummary | None = None) -> Study:
    """Return a made-up study in which halving the step quarters the error and doubles the time."""
    steps = (4e-3, 2e-3, 1e-3)
    settings = StudySettings(
        steps, ("implicit", "explicit"), segments, common_instants(steps, 1.0), 1
    )
    known = {"tip_position": 1e-9, "joint_angles": 1e-9, "energy": 1e-9}
    reference = Reference(np.zeros((1, 1)), known, known, known, 1e-4)  # type: ignore[arg-type]
    cuts = tuple(Discretization(count, 10, reference, 0.1, 1.0, model) for count in segments)
    cases = []
    for count in segments:
        for step in steps:
            error = ErrorSummary(step**2, step**2, step**2)
            errors = {"tip_position": error, "joint_angles": error, "energy": error}
            case = StudyCase(
                count, "implicit", step, round(1 / step), "ok", "", 0.01 / step / 100, errors
            )  # type: ignore[arg-type]
            cases.append(case)
        cases.append(StudyCase(count, "explicit", 4e-3, 250, "diverged", "why"))
    error = math.nan if model is None else 1e-6
    name = "" if model is None else "elastica"
    return Study(settings, scene_from_file("scene.yaml"), cuts, tuple(cases), name, error)


@pytest.mark.moderate
def test_the_same_study_gives_the_same_bytes_whatever_the_style() -> None:
    first = draw(study(), "finger")
    with matplotlib.rc_context({"figure.facecolor": "black", "lines.linewidth": 9}):
        assert draw(study(), "finger") == first
    assert first["png"].startswith(b"\x89PNG\r\n\x1a\n")
    assert set(first) == {"png", "svg"}


def texts(svg: bytes) -> list[str]:
    """Return what is written in the picture; matplotlib draws glyphs, and says what they spell."""
    return re.findall(r"<!-- (.+?) -->", svg.decode("utf-8"))


def test_curves_steps_and_lines_are_labelled() -> None:
    written = texts(draw(study(), "finger")["svg"])
    assert {"implicit", "4 ms", "2 ms", "1 ms", "error of the reference", "finger"} <= set(written)
    assert "explicit" not in written


@pytest.mark.moderate
def test_segments_and_the_error_of_the_chain_are_labelled() -> None:
    model = ErrorSummary(1e-4, 1e-4, 1e-4)
    written = texts(draw(study((5, 10), model), "finger")["svg"])
    assert {"implicit, 5 segments", "implicit, 10 segments"} <= set(written)
    assert "error of the chain, 5 segments" in written


def test_a_study_without_a_point_is_an_empty_sheet() -> None:
    empty = dataclasses.replace(study(), cases=study().cases[-1:])
    written = texts(draw(empty, "finger")["svg"])
    assert "error of the reference" in written


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_no_date_and_no_version_is_in_the_file(kind: str) -> None:
    content = draw(study(), "finger")[kind]
    assert b"<dc:date>" not in content
    assert b"Software" not in content
