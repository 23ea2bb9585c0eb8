"""Matrices with the properties of an inertia."""

from __future__ import annotations

import numpy as np


def positive_definite(random: np.random.Generator, n: int) -> np.ndarray:
    """Draw a symmetric positive definite matrix, shape (n, n), its eigenvalues n and more."""
    root = random.normal(size=(n, n))
    return root @ root.T + n * np.eye(n)
