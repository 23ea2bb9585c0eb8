"""Cross products of many vectors as matrices: numpy's own function is slow, and steps need many."""

from __future__ import annotations

import numpy as np

from somo_cli.arrays import Array


def skew_matrices(vectors: Array) -> Array:
    """Return the matrices, (n, 3, 3), whose product with a vector w is the cross product v x w."""
    matrices: Array = np.zeros((len(vectors), 3, 3))
    x, y, z = vectors.T
    matrices[:, 0, 1], matrices[:, 1, 0] = -z, z
    matrices[:, 0, 2], matrices[:, 2, 0] = y, -y
    matrices[:, 1, 2], matrices[:, 2, 1] = -x, x
    return matrices
