"""How chains follow beams, against numbers of another computation."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.calibration.beam_comparison import (
    BeamComparison,
    compare_placements,
    compare_with_beam,
)
from somo_cli.calibration.moment_arms import MomentArms, of_uniform_actuator
from somo_cli.manipulator.definition import Placement

X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def of_one_axis(
    count: int, placement: Placement = "uniform", length: float = 1.0
) -> BeamComparison:
    return compare_with_beam(of_uniform_actuator(length, count, 1, 0, X, placement), placement)


@pytest.mark.parametrize(
    # tip-matched chains in the elastica's load P L²/EI = 1: Newton on the chain against the closed
    # form of Bisshopp and Drucker, two significant digits
    ("count", "uniform", "gauss"),
    [(3, None, 1.6e-3), (5, 1.2e-3, 6.4e-4), (10, 3.0e-4, None), (20, 7.6e-5, None)],
)
def test_large_loads(count: int, uniform: float | None, gauss: float | None) -> None:
    for placement, expected in (("uniform", uniform), ("gauss", gauss)):
        if expected is not None:
            found = of_one_axis(count, "gauss" if placement == "gauss" else "uniform").large
            assert found == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize("count", [3, 5, 10, 40])
def test_an_end_moment_bends_a_matched_chain_too_much(count: int) -> None:
    # 1/(4N²) over 1 - 1/(4N²): the chain with N EI/L has the moment exact, the force not
    quarter = 1 / (4 * count**2)
    assert of_one_axis(count).moment == pytest.approx(quarter / (1 - quarter))


@pytest.mark.parametrize("count", [2, 3, 8])
def test_at_gauss_points_force_moment_and_weight_are_exact(count: int) -> None:
    found = of_one_axis(count, "gauss")
    assert found.moment == pytest.approx(0, abs=1e-12)
    assert found.weight == pytest.approx(0, abs=1e-12)
    assert abs(found.weight) < abs(of_one_axis(count).weight)


def test_a_chain_of_three_is_as_good_as_one_of_seven() -> None:
    assert of_one_axis(3, "gauss").frequency == pytest.approx(0, abs=6e-4)
    assert abs(of_one_axis(3, "gauss").frequency) < abs(of_one_axis(7).frequency)
    # untouched by the tip match: three and seven joints of the same rigidity, load 1
    assert of_one_axis(3, "gauss").large < of_one_axis(4).large


@pytest.mark.parametrize(
    # first frequency of chains with N EI/L: +9.3e-3, +2.3e-3, +5.7e-4; matched ones are softer by
    # 1/(8N²)
    ("count", "rigid"),
    [(5, 9.3e-3), (10, 2.3e-3), (20, 5.7e-4)],
)
def test_the_first_frequency(count: int, rigid: float) -> None:
    assert of_one_axis(count).frequency == pytest.approx(rigid - 1 / (8 * count**2), rel=0.03)


def test_errors_at_tenths_of_the_length() -> None:
    found = of_one_axis(2)
    # one hinge at L/4, one at 3L/4, straight in between; the tip is matched
    s = np.linspace(0, 1, 11)
    stiffness = found.moment_arms.stiffness(3.0)
    chain = sum(np.maximum(s - x, 0) * (1 - x) / stiffness for x in (0.25, 0.75))
    assert found.profile == pytest.approx(3 * chain - s * s * (3 - s) / 2)
    assert found.profile[[0, -1]] == pytest.approx([0, 0], abs=1e-12)
    assert np.abs(found.profile).max() <= found.along


def test_crowded_joints_leave_the_first_frequency_its_digits() -> None:
    many = of_one_axis(121, "gauss")
    assert many.frequency == pytest.approx(0, abs=1e-7)
    assert many.top > of_one_axis(121).top


def test_a_gauss_chain_pays_with_its_highest_frequency() -> None:
    assert of_one_axis(5, "gauss").top / of_one_axis(5).top == pytest.approx(3, abs=0.1)


def test_the_length_does_not_matter() -> None:
    one, other = of_one_axis(5), of_one_axis(5, length=0.07)
    for name in ("along", "moment", "weight", "large", "frequency", "top"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), rel=1e-9)


def test_twisted_chains() -> None:
    found = compare_with_beam(of_uniform_actuator(2.0, 4, 1, 0, Z, "uniform"), "uniform")
    assert found.along == pytest.approx(1 / 8, abs=3e-3)  # half a step, where links meet
    # N equal springs and discs, the last a half: 2 N sin(pi / 4N), against pi / 2
    assert found.frequency == pytest.approx(16 * math.sin(math.pi / 16) / math.pi - 1)
    assert found.moment != found.moment  # nan: a twisted beam has no deflection


def test_both_placements_of_every_number_are_compared() -> None:
    def made(count: int, placement: Placement) -> MomentArms:
        return of_uniform_actuator(1, count, 2, 1, X, placement)

    found = [(one.moment_arms.count, one.placement) for one in compare_placements(made, (2, 5))]
    assert found == [(2, "uniform"), (2, "gauss"), (5, "uniform"), (5, "gauss")]
    assert all(one.moment_arms.stiffness(3.0) > 0 for one in compare_placements(made, (2, 5)))
