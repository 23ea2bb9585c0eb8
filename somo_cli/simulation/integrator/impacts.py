"""Impacts, told from smooth motion: what of a change in one step may be expected in the next."""

from __future__ import annotations

import numpy as np

from somo_cli.arrays import Array

IMPACT_RATIO = 2.0  # a change larger than this times the one before counts as an impact
SMOOTH = 5e-3  # rad: below it, a change of rate in a step, times the step, counts as smooth


def limited_change(change: Array, before: Array, small: float) -> Array:
    """Return the part of the change in the last step that may be extrapolated, shape (n,).

    `before` is the change in the step before. Changes up to `small` and those of smooth motion stay
    whole; what an impact has added is limited, number by number (a minmod).
    """
    if change.dot(change) <= small * small or float(np.abs(change).max()) <= small:
        return change
    ahead = np.sign(change) * np.minimum(np.abs(change), IMPACT_RATIO * np.abs(before))
    limited = np.where(change * before > 0, ahead, 0.0)
    return np.where(np.abs(change) > small, limited, change)
