"""Matrices with the properties of an inertia, and stiffness from torques by differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def positive_definite(random: np.random.Generator, n: int) -> np.ndarray:
    """Draw a symmetric positive definite matrix, shape (n, n), its eigenvalues n and more."""
    root = random.normal(size=(n, n))
    return root @ root.T + n * np.eye(n)


def stiffness_by_differences(
    torques: Callable[[np.ndarray], np.ndarray], angles: np.ndarray
) -> np.ndarray:
    """Return minus the gradient of torques [N·m] over angles [rad], by central differences."""
    steps = 1e-6 * np.eye(len(angles))
    gradients = [(torques(angles - step) - torques(angles + step)) / 2e-6 for step in steps]
    return np.array(gradients).T
