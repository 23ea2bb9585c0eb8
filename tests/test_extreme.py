"""A small part of `make extreme`: what holds, what is refused, and what is said beforehand."""

from __future__ import annotations

import dataclasses
import functools

import pytest

from somo_cli.scene.model import Integrator
from tests.extreme.__main__ import MATRIX
from tests.extreme.case import Case, read_cases
from tests.extreme.edge import MARGIN, edge, is_stable, predicted_limit
from tests.extreme.trial import Outcome, outcome
from tests.extreme.verdict import HEADER, Verdict, matrix, summary, verdict

pytestmark = pytest.mark.slow

CASES = {case.name: case for case in read_cases()}
# each broke a law before it was as it is now, or is the farthest of its kind
HOLD = (
    "finger: at rest",
    "stiffness: x 1e9, large steps",
    "damping: hundredfold, stiff",
    "step: 5e-2 s, critical, whipped",
    "joints: forty, stiff",
    "mass: heavy tip x 1e6",
    "mass: feather links x 1e-6, large steps",
    "gravity: hundredfold, hanging, large steps",
    "limits: struck, forty joints",
    "limits: struck, feather links",
    "neutral: far from zero, stiff",
)
REFUSED = {
    "mass: heavy links": "large-inertia",
    "shape: 1 mm, world scale 1": "frozen-joint",
}


@functools.cache
def found(name: str) -> Verdict:
    return verdict(CASES[name])


@pytest.mark.parametrize("integrator", ["implicit", "euler"])
@pytest.mark.parametrize("name", HOLD)
def test_damped_cases_come_through(name: str, integrator: Integrator) -> None:
    run = outcome(CASES[name], integrator)
    assert run.is_stable
    assert not run.is_restless
    assert not run.is_creative


@pytest.mark.parametrize("name", ["finger: as shipped", "joints: one, stiff", "mass: no tip"])
def test_the_explicit_limit_is_where_it_is_predicted(name: str) -> None:
    limit = predicted_limit(CASES[name])
    assert limit is not None
    assert is_stable(CASES[name], limit / MARGIN)
    assert not is_stable(CASES[name], 1.3 * limit)


@pytest.mark.parametrize(("name", "code"), REFUSED.items())
def test_what_the_engine_refuses_is_said_beforehand(name: str, code: str) -> None:
    one = found(name)
    assert one.implicit.refused is not None
    assert code in one.said
    assert edge(one.case) is None
    assert not one.is_surprise


def test_a_motion_that_no_step_follows_is_distinguished_from_divergence_and_predicted() -> None:
    one = found("torque: saturate")
    assert one.implicit.diverged is not None
    assert one.implicit.is_too_fast
    assert "fast-joints" in one.said
    assert not one.is_hole


def test_the_committed_matrix_is_of_these_cases_and_has_no_hole() -> None:
    text = MATRIX.read_text("utf-8")
    heading, *lines = text.partition("\n\n")[0].splitlines()
    width = heading.index(HEADER[1])
    assert [line[:width].rstrip() for line in lines] == list(CASES)
    assert "damped cases in which implicit or euler fail: 0\n" in text
    assert "`somo check --numerics` does not say: 0\n" in text


ODD = Case("odd: one")
FINE = Outcome(apart=0.0, is_due=True)
BAD = (
    (Outcome(diverged=8), "diverges"),
    (Outcome(apart=0.1, is_due=True), "restless <1e0"),
    (Outcome(apart=None, is_due=True), "restless"),
    (Outcome(gain=0.5), "gains <1e0"),
    (Outcome(gain=float("nan")), "gains"),
    (Outcome(lost=0.5), "loses <1e0"),
)


@pytest.mark.parametrize(("bad", "reported"), BAD)
def test_a_failure_is_a_hole_if_the_case_is_damped(bad: Outcome, reported: str) -> None:
    one = Verdict(ODD, bad, FINE, FINE, None, ())
    assert one.is_hole
    assert reported in one.cells[1]
    assert one.cells[2] == "rests <1e-09"
    assert "fail: 1\n  odd: one\n" in summary([one, *[found("finger: at rest")]])
    assert matrix([one]).splitlines()[1].startswith("odd: one")
    undamped = dataclasses.replace(one, case=dataclasses.replace(ODD, damping=0))
    assert not undamped.is_hole


def test_what_cannot_run_without_a_word_beforehand_is_a_surprise() -> None:
    assert Verdict(ODD, Outcome(refused="no"), FINE, FINE, None, ()).is_surprise
    assert not Verdict(ODD, Outcome(refused="no"), FINE, FINE, None, ("code",)).is_surprise
    assert not Verdict(ODD, FINE, FINE, Outcome(diverged=8), None, ()).is_surprise
