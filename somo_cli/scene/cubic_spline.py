"""Compute the slopes of cubic splines through values over time.

The splines are twice continuously differentiable, as those of scipy's CubicSpline. That import
takes longer than most runs take to start.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise


def clamped_slopes(times: Sequence[float], values: Sequence[float]) -> list[float]:
    """Return the slope at every time of the spline whose slope is zero at both ends."""
    widths, chords = _widths_and_chord_slopes(times, values)
    inner = range(1, len(widths))
    # h_i m_(i-1) + 2 (h_(i-1) + h_i) m_i + h_(i-1) m_(i+1) = 3 (h_i d_(i-1) + h_(i-1) d_i), with
    # widths h, chord slopes d and slopes m; de Boor, A Practical Guide to Splines, ch. IV
    solution = _solve_tridiagonal(
        [widths[i] for i in inner],
        [2 * (widths[i - 1] + widths[i]) for i in inner],
        [widths[i - 1] for i in inner],
        [3 * (widths[i] * chords[i - 1] + widths[i - 1] * chords[i]) for i in inner],
    )
    return [0.0, *solution, 0.0]


def periodic_slopes(times: Sequence[float], values: Sequence[float]) -> list[float]:
    """Return the slope at every time of the periodic spline; the first and last slope are equal."""
    widths, chords = _widths_and_chord_slopes(times, values)
    n = len(widths)
    if n == 1:
        return [0.0, 0.0]
    # the same equations with periodic indices: a tridiagonal matrix plus two corner elements,
    # which are u vᵀ with u = (c, 0, ..., h_-2) and v = (1, 0, ..., h_0 / c); the formula of
    # Sherman and Morrison inverts the sum
    diagonal = [2 * (widths[i - 1] + widths[i]) for i in range(n)]
    c = -diagonal[0]
    share = widths[0] / c
    diagonal[0] -= c
    diagonal[-1] -= widths[-2] * share
    below, above = widths, [widths[i - 1] for i in range(n)]
    right_side = [3 * (widths[i] * chords[i - 1] + widths[i - 1] * chords[i]) for i in range(n)]
    y = _solve_tridiagonal(below, diagonal, above, right_side)
    z = _solve_tridiagonal(below, diagonal, above, [c, *[0.0] * (n - 2), widths[-2]])
    factor = (y[0] + share * y[-1]) / (1 + z[0] + share * z[-1])
    solution = [one - factor * other for one, other in zip(y, z, strict=True)]
    return [*solution, solution[0]]


def _widths_and_chord_slopes(
    times: Sequence[float], values: Sequence[float]
) -> tuple[list[float], list[float]]:
    widths = [after - before for before, after in pairwise(times)]
    rises = [after - before for before, after in pairwise(values)]
    return widths, [rise / width for rise, width in zip(rises, widths, strict=True)]


def _solve_tridiagonal(
    below: Sequence[float],
    diagonal: Sequence[float],
    above: Sequence[float],
    right_side: list[float],
) -> list[float]:
    """Return the solution of a tridiagonal system with a diagonally dominant matrix.

    All arguments have the same length; `below[0]` and `above[-1]` are not used.
    """
    pivots, solution = list(diagonal), list(right_side)
    for i in range(1, len(solution)):
        share = below[i] / pivots[i - 1]
        pivots[i] -= share * above[i - 1]
        solution[i] -= share * solution[i - 1]
    for i in reversed(range(len(solution))):
        rest = above[i] * solution[i + 1] if i + 1 < len(solution) else 0.0
        solution[i] = (solution[i] - rest) / pivots[i]
    return solution
