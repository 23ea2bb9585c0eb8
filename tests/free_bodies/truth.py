"""The true motion of bodies that spin: closed forms, and quadratures of what is kept."""

from __future__ import annotations

import numpy as np
from scipy.special import ellipj

from somo_cli.arrays import Array
from tests.free_bodies.bodies import Spinning


def rotation_of(vector: Array) -> Array:
    """Return exp of a rotation vector [rad], shape (3, 3)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def symmetric_top(body: Spinning, time: float) -> Array:
    """Return the orientation of a free body with two equal moments, x and y; closed form.

    It turns about its momentum at the rate L / I_x, and about its own axis at the rest.
    """
    across, _, along = body.moments
    momentum = body.momentum
    own = np.array([0.0, 0.0, body.rate[2] * (1 - along / across)])
    return rotation_of(momentum / across * time) @ rotation_of(own * time)


def jacobi_rates(body: Spinning, times: Array) -> Array:
    """Return the rates of a free body in its own axes, shape (rows, 3); by Jacobi's functions.

    For moments that grow from x to z and a start with no rate about y (Landau and Lifshitz,
    Mechanics, § 37), energy and momentum such that L² > 2 E I_y.
    """
    (a, b, c), (x, y, z) = body.moments, body.rate
    assert a < b < c
    assert y == 0
    assert z > 0
    twice = a * x * x + c * z * z
    square = (a * x) ** 2 + (c * z) ** 2
    assert square > twice * b
    pace = np.sqrt((c - b) * (square - twice * a) / (a * b * c))
    modulus = (b - a) * (twice * c - square) / ((c - b) * (square - twice * a))
    sn, cn, dn, _ = ellipj(pace * times, modulus)
    size = np.sqrt((twice * c - square) / (b * (c - b)))
    return np.array([abs(x) * cn * np.sign(x), np.sign(x) * size * sn, z * dn]).T


def orientation(body: Spinning, time: float, steps: int = 20000) -> Array:
    """Return the orientation of a body that is free, or rolls without slip (Chaplygin's ball).

    What is kept, the momentum about the centre or the point of contact, gives the angular velocity
    for every orientation; a Runge-Kutta rule of order four and small steps integrates that.
    """
    momentum, moments = body.momentum, np.diag(body.moments)
    extra = body.mass * body.radius**2 * np.diag([1, 1, 0]) if body.rolls else np.zeros((3, 3))
    step = time / steps

    def velocity(turned: Array) -> Array:
        x, y, z = np.linalg.solve(turned @ moments @ turned.T + extra, momentum)
        return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ turned

    turned = np.eye(3)
    for _ in range(steps):
        first = velocity(turned)
        second = velocity(turned + step / 2 * first)
        third = velocity(turned + step / 2 * second)
        turned = turned + step / 6 * (
            first + 2 * second + 2 * third + velocity(turned + step * third)
        )
    return turned
