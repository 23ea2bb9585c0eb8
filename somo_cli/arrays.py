"""Arrays of numbers: their type, and the inverse that the stepping loop can afford."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]

# seen in numpy 2.4: around ten joints, what numpy puts around its own inverse costs more than that
invert: Callable[[Array], Array] = getattr(np.linalg, "_umath_linalg", np.linalg).inv
"""Returns the inverse of a matrix; NaN for a singular one, which the divergence monitor reports."""
