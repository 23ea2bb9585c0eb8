"""Time steps that people write: 1, 2 or 5 times a power of ten."""

from __future__ import annotations

import math

LARGEST_STEP = 0.05  # s, that is ever recommended


def round_down_step(step: float) -> float:
    """Return the largest value of 1, 2 or 5 times a power of ten that is not larger [s]."""
    if not step < LARGEST_STEP:
        return LARGEST_STEP
    exponent = math.floor(math.log10(step))
    fits = [float(f"{digit}e{exponent}") for digit in (1, 2, 5)]
    return max((one for one in fits if one <= step), default=float(f"5e{exponent - 1}"))
