"""Find where a function of several variables leaves them as they are, by Broyden's method."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from somo_cli.arrays import Array

MAX_CHANGE = 1e100  # of a number in a round: beyond it products overflow, and nothing is found


def fixed_point(
    function: Callable[[Array], Array], start: Array, tolerance: float, max_rounds: int
) -> Array | None:
    """Return x, shape (n,), with f(x) = x to within `tolerance` in every number.

    The first round takes f itself; from what the rounds change the slope of f is learned, so that
    it may be steep. f is called last with the result. None if `max_rounds` do not lead there.

    Broyden, Math. Comp. 19 (1965) 577, the first of the two methods, in the form for the inverse.
    """
    x = start
    off = function(x) - x
    inverse: Array | None = None  # of the slope of x - f
    for _ in range(max_rounds):
        size = _size(off)
        if size <= tolerance:
            return x
        if not size < MAX_CHANGE:
            return None
        step = off if inverse is None else inverse @ off
        x = x + step
        before, off = off, function(x) - x
        if inverse is None:
            inverse = np.eye(len(x))
        # off changes by minus the slope times the step
        predicted = inverse @ (before - off)
        along = float(step.dot(predicted))
        if along == 0 or not math.isfinite(along):
            break
        inverse = inverse + np.outer(step - predicted, (step @ inverse) / along)
    return x if _size(off) <= tolerance else None


def _size(vector: Array) -> float:
    return float(np.abs(vector).max())
