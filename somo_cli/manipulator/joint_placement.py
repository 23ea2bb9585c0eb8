"""Place the joints of an actuator along its backbone, each with the length that it represents.

Evenly placed joints are in the middle of equal parts of the backbone; the error of such a chain is
of second order in the number of joints. Alternatively joints are at the points x_i of a Gauss rule,
and each represents the part w_i of the length. The work of small loads is then a quadrature that is
exact for polynomials: with few joints the tip deflects like that of a beam, under a force or a
moment on the tip and under its own weight.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from somo_cli.manipulator.definition import (
    ActuatorDefinition,
    JointDefinition,
    LinkDefinition,
    Placement,
)

_MAX_SHIFT = 0.4
"""The shift that keeps Gauss points of several axes apart; from 0.5 on some change their order."""


@dataclass(frozen=True, slots=True)
class JointLayout:
    """The n joints along an actuator of length 1, base to tip, and the links between them.

    `places` has the positions of the joints, shape (n,). `shares` has the length of backbone that
    each represents, relative to an evenly placed joint, shape (n,). `fractions` has the lengths of
    the links relative to a full link, which is 1 / n of the actuator, shape (n + 1,).
    """

    places: tuple[float, ...]
    shares: tuple[float, ...]
    fractions: tuple[float, ...]


def layout(placement: Placement, channels: Sequence[int], axes: int) -> JointLayout:
    """Return the layout of joints whose axes are `channels`, base to tip.

    `axes` is the number of alternating axes. Each axis has its own Gauss rule, for its joints only.
    If several axes have the same number of joints, their points are shifted apart.
    """
    count = len(channels)
    if placement == "uniform":
        places = tuple((number + 0.5) / count for number in range(count))
        ends = (0.5,) + (1.0,) * (count - 1) + (0.5,)
        return JointLayout(places, (1.0,) * count, ends)
    numbers = [channels.count(channel) for channel in range(axes)]
    rules = [iter(gauss(n, _shift(channel, numbers))) for channel, n in enumerate(numbers)]
    points = [next(rules[channel]) for channel in channels]
    ends = (0.0, *(place for place, _ in points), 1.0)
    return JointLayout(
        ends[1:-1],
        tuple(weight * count / axes for _, weight in points),
        tuple((after - before) * count for before, after in pairwise(ends)),
    )


def actuator_of(
    link: LinkDefinition,
    placement: Placement,
    joints: tuple[JointDefinition, ...],
    channels: tuple[int, ...],
    axes: int,
    taper: float = 1.0,
) -> ActuatorDefinition:
    """Return the actuator of these joints, whose properties are those of evenly placed joints."""
    where = layout(placement, channels, axes)
    return ActuatorDefinition(
        link=link,
        placement=placement,
        joints=joints,
        channels=channels,
        spans=tuple(share * axes * link.height for share in where.shares),
        shares=where.shares,
        fractions=where.fractions,
        taper=taper,
    )


def scaled_to_share(joint: JointDefinition, share: float) -> JointDefinition:
    """Return the joint that represents `share` times as much of the same continuous backbone.

    Stiffness and damping are divided by the share. Angles (limits, neutral position) and the
    velocity limit are multiplied by it, so that the limits of curvature do not change. Torques (dry
    friction, effort) are moments in the backbone and do not change.
    """
    # a joint without limits has lower > upper, a pair that URDF readers expect as it is
    limit = share if joint.lower <= joint.upper else 1.0
    return replace(
        joint,
        lower=joint.lower * limit,
        upper=joint.upper * limit,
        velocity=joint.velocity * share,
        stiffness=joint.stiffness / share,
        damping=joint.damping / share,
        neutral_position=joint.neutral_position * share,
    )


def gauss(count: int, shift: float = 0.0) -> tuple[tuple[float, float], ...]:
    """Return the n points and weights of a Gauss rule on [0, 1], ascending; weights add up to 1.

    The points are the zeros of P_n + c P_{n-1}, with Legendre polynomials of 2 x - 1 and the
    `shift` c, between -1 and 1. For c = 0 they are the Gauss-Legendre points, and the rule is exact
    for polynomials of degree 2 n - 1; otherwise to degree 2 n - 2. For c > 0 the points move
    towards 0, for c < 0 towards 1, by less than the distance to the next zero of P_{n-1}. All
    weights are positive. Shohat, Trans. Amer. Math. Soc. 42 (1937) 461; Davis and Rabinowitz,
    Methods of Numerical Integration (1984), sec. 2.7.
    """
    points = []
    for number in range(count, 0, -1):
        x = _first_guess(count, number, shift)
        for _ in range(50):
            legendre = _legendre(count, x)
            value = legendre[count] + shift * legendre[count - 1]
            slope = _derivative(legendre, count, x) + shift * _derivative(legendre, count - 1, x)
            move = value / slope
            x -= move
            if abs(move) < 1e-15:
                break
        # w = 1 / sum of the squares of the orthonormal polynomials (Christoffel)
        squares = ((2 * k + 1) * value * value for k, value in enumerate(_legendre(count - 1, x)))
        # rounded, since the last digits depend on the cosine of the C library
        points.append((round((x + 1) / 2, 15), round(1 / math.fsum(squares), 15)))
    return tuple(points)


def _shift(channel: int, numbers: Sequence[int]) -> float:
    alike = [other for other, number in enumerate(numbers) if number == numbers[channel]]
    if len(alike) == 1:
        return 0.0
    return _MAX_SHIFT * (1 - 2 * alike.index(channel) / (len(alike) - 1))


def _first_guess(count: int, number: int, shift: float) -> float:
    # P_n(cos t) is about cos((n + 1/2) t - pi/4) times a slowly varying factor (Szegő, 8.21.2)
    angle = (number - 0.25) * math.pi / (count + 0.5)
    for _ in range(10):
        turn = math.atan2(shift * math.sin(angle), 1 + shift * math.cos(angle))
        angle = ((number - 0.25) * math.pi + turn) / (count + 0.5)
    return math.cos(angle)


def _legendre(count: int, x: float) -> list[float]:
    values = [1.0, x]
    for k in range(1, count):
        values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
    return values[: count + 1]


def _derivative(legendre: Sequence[float], degree: int, x: float) -> float:
    if degree == 0:
        return 0.0
    return degree * (x * legendre[degree] - legendre[degree - 1]) / (x * x - 1)
