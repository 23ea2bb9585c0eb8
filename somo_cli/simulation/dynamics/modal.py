"""Small vibrations of M q'' + D q' + K q = 0: natural frequencies, modes, the explicit limit."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from somo_cli.arrays import Array

MIN_JOINT_INERTIA = 2.2e-16
"""PyBullet 3.2.7 takes a joint that feels less inertia than this [engine units] to be held."""


def natural_frequencies(mass: Array, stiffness: Array) -> Array:
    """Return the natural frequencies [rad/s] without damping, lowest first, shape (n,).

    `mass` has shape (n, n); `stiffness` too, or it is the diagonal, (n,). A mode of negative
    stiffness, which topples, counts as zero. Raises numpy.linalg.LinAlgError for a mass matrix that
    is not positive definite.
    """
    squares = np.linalg.eigvalsh(mass_normalisation(mass)[0](stiffness))
    frequencies: Array = np.sqrt(np.maximum(squares, 0.0))
    return frequencies


def largest_explicit_step(mass: Array, stiffness: Array, damping: Sequence[float] | Array) -> float:
    """Return the largest stable step [s] of the explicit law; infinity without springs, dampers.

    The linearised chain is stable exactly while 4 M - 2 h D - h² K, the characteristic matrix
    M (z - 1)² + h D (z - 1) + h² K z at z = -1, is positive definite. Shapes and errors are those
    of `natural_frequencies`.
    """
    normalised, _ = mass_normalisation(mass)
    k, d = normalised(stiffness), normalised(np.asarray(damping))
    fastest, most_damped = (float(np.linalg.eigvalsh(matrix)[-1]) for matrix in (k, d))
    # springs or dampers alone allow a longer step than both; a quarter of it is always stable
    alone = [2 / math.sqrt(fastest)] if fastest > 0 else []
    alone += [2 / most_damped] if most_damped > 0 else []
    if not alone:
        return math.inf
    low, high = min(alone) / 4, min(alone)
    for _ in range(50):
        h = (low + high) / 2
        is_stable = np.linalg.eigvalsh(2 * h * d + h * h * k)[-1] < 4
        low, high = (h, high) if is_stable else (low, h)
    return low


def articulated_inertia(mass: Array) -> Array:
    """Return the inertia that each joint feels while those beyond it move freely, shape (n,).

    The diagonal of D in M = Lᵀ D L, by which the engine divides: Featherstone, Rigid Body
    Dynamics Algorithms (2008), sec. 6.5. Raises numpy.linalg.LinAlgError.
    """
    inertia: Array = np.diag(np.linalg.cholesky(mass[::-1, ::-1]))[::-1] ** 2
    return inertia


def mass_normalisation(mass: Array) -> tuple[Callable[[Array], Array], Callable[[Array], Array]]:
    """Return a function that normalises a matrix to unit mass, and one that transforms shapes back.

    With M = L Lᵀ the first gives L⁻¹ A L⁻ᵀ, the second L⁻ᵀ v. Raises numpy.linalg.LinAlgError.
    """
    # a unit diagonal keeps most digits of the lightest links
    scale = 1 / np.sqrt(np.diag(mass))
    inverse = np.linalg.inv(np.linalg.cholesky(mass * np.outer(scale, scale))) * scale

    def normalised(matrix: Array) -> Array:
        whole: Array = inverse @ (np.diag(matrix) if matrix.ndim == 1 else matrix) @ inverse.T
        return (whole + whole.T) / 2

    def shaped(vectors: Array) -> Array:
        shapes: Array = inverse.T @ vectors
        return shapes

    return normalised, shaped
