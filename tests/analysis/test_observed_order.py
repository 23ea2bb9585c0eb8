"""The order that three runs show, and the share of their distance that is error."""

from __future__ import annotations

import math

import numpy as np
import pytest

from somo_cli.analysis.observed_order import (
    IRREGULAR_SHARE,
    LEAST_ORDER,
    STRIKING_SHARE,
    observed_order,
)


def of(before: np.ndarray, after: np.ndarray, nominal: int = 2):
    return observed_order(
        float(before @ before), float(before @ after), float(after @ after), nominal
    )


CURVE = np.sin(np.linspace(0, 7, 50))


@pytest.mark.parametrize("order", [0.8, 1.0, 1.5, 2.0])
def test_errors_that_fall_regularly_are_extrapolated_with_their_order(order: float) -> None:
    error = 0.3 * CURVE  # of the run in the middle; those of the others by the order
    coarse, fine = 2**order * error, 2**-order * error
    found = of(coarse - error, error - fine)
    assert found.value == pytest.approx(order)
    told = found.share_of_run * (error - fine)
    assert told == pytest.approx(error)
    assert found.share_of_finer * (error - fine) == pytest.approx(fine)
    assert found.expected == pytest.approx(order)
    assert not found.is_irregular


def test_orders_that_no_method_has_are_bounded() -> None:
    fast = of(64 * CURVE, CURVE)
    assert fast.value == pytest.approx(6)
    assert fast.share_of_run == pytest.approx(4 / 3)
    slow = of(1.1 * CURVE, CURVE)
    assert slow.share_of_run == pytest.approx(1 / (1 - 2**-LEAST_ORDER))
    assert of(4 * CURVE, CURVE, nominal=1).share_of_run == 2
    assert of(0.5 * CURVE, CURVE).is_growing


def test_differences_that_are_not_parallel_have_no_order() -> None:
    found = of(CURVE, np.cos(np.linspace(0, 7, 50)))
    assert found.is_irregular
    assert math.isnan(found.value)
    assert (found.share_of_run, found.share_of_finer) == (IRREGULAR_SHARE, IRREGULAR_SHARE / 2)
    assert of(-CURVE, CURVE).is_irregular


def test_runs_that_agree_to_the_last_bit_have_no_order() -> None:
    for before, after in ((0 * CURVE, CURVE), (CURVE, 0 * CURVE)):
        found = of(before, after)
        assert math.isnan(found.value)
        assert found.share_of_run == pytest.approx(4 / 3)


def striking(before: np.ndarray, after: np.ndarray, nominal: int = 2):
    products = float(before @ before), float(before @ after), float(after @ after)
    return observed_order(*products, nominal, is_striking=True)


@pytest.mark.parametrize(("fall", "order"), [(1.1, 1.0), (2.0, 1.0), (2.2, 1.14), (8.0, 1.25)])
def test_where_joints_strike_an_order_near_one_is_believed(fall: float, order: float) -> None:
    """A fall by eight from three runs is chance there, and no third order."""
    found = striking(fall * CURVE, CURVE)
    assert found.share_of_run == pytest.approx(1 / (1 - 2**-order), rel=5e-3)
    assert found.share_of_finer == pytest.approx(found.share_of_run - 1)
    assert found.expected == pytest.approx(order, rel=5e-3)


def test_where_joints_strike_without_an_order_more_is_told() -> None:
    found = striking(CURVE, np.roll(CURVE, 10))
    assert found.is_irregular
    assert found.share_of_run == STRIKING_SHARE
    assert striking(0 * CURVE, CURVE).share_of_run == 2  # first order, where none is observed
    assert striking(8 * CURVE, CURVE, nominal=1).share_of_run == 2
