"""A second opinion on the crawling snake: the same planar chain, written down anew.

Rigid links in the plane, their angles to the world as coordinates (Lagrange's equations), springs
and dampers between them, and the friction of Hu and others, PNAS 106 (2009) 10081, at the points
that the engine's snake stands on, each of which bears the same share of the weight. It knows
neither the engine, nor its steps, nor the spring law.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from somo_cli.arrays import Array
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.solids import Box

GRAVITY = 9.81  # m/s²
SMOOTHING = 1e-3  # m/s: below it friction goes linearly to zero; a third of it changes 1e-5


@dataclass(frozen=True, slots=True)
class Gait:
    """A wave of torque along the actuators [N·m, Hz, rad], and the belly's friction."""

    amplitude: float
    frequency: float
    lag: float
    friction: float
    along: float
    """The factor of the friction along the body; across it is 1."""


class PlanarSnake:
    """A chain of boxes with joints about one axis, laid on its side along the world's x."""

    def __init__(self, chain: Chain) -> None:
        """Take lengths, masses and springs of a chain of boxes whose joints are all about x."""
        places = [joint.origin[2] for joint in chain.joints]
        width = _boxes(chain)[0][1].size[1]
        self.lengths = np.array([*places, chain.length - sum(places)])
        self.masses = np.array([link.inertial.mass for link in chain.links])
        self.spins = self.masses * (self.lengths**2 + width**2) / 12
        self.stiffness = np.array([joint.stiffness for joint in chain.joints])
        self.damping = np.array([joint.damping for joint in chain.joints])
        self.actuators = np.array([joint.actuator for joint in chain.joints])
        links, heights = _feet(chain)
        self._links = np.repeat(links, 2)
        self._arms = self._reach(self._links, np.repeat(heights, 2))
        self._sides = np.tile([-width / 2, width / 2], len(links))
        everywhere = np.arange(len(self.masses))
        self._centres = self._reach(everywhere, self.lengths / 2)
        self.shares = self.masses @ self._centres / self.masses.sum()
        self._pairs = self._centres.T @ (self.masses[:, None] * self._centres)

    def centres(self, gait: Gait, times: Array) -> Array:
        """Return where its centre of mass is at these times, shape (2, t), from rest at the origin.

        It starts straight, its centre in the origin.
        """
        start = np.zeros(2 * (len(self.masses) + 2))
        start[0] = -self.lengths.sum() / 2
        found = solve_ivp(
            lambda t, y: self.rates(gait, t, y), (0, times[-1]), start,
            method="LSODA", t_eval=times, rtol=1e-4, atol=1e-6,
        )  # fmt: skip
        turns = found.y[2 : len(self.masses) + 2]
        return found.y[:2] + np.array([self.shares @ np.cos(turns), self.shares @ np.sin(turns)])

    def rates(self, gait: Gait, time: float, state: Array) -> Array:
        """Return the rates of place of the base, angles of the links, and of their rates."""
        size = len(state) // 2
        turns, rates = state[2:size], state[size:]
        cosines, sines = np.cos(turns), np.sin(turns)
        weights = self.masses.sum() * self.shares
        matrix = np.zeros((size, size))
        matrix[0, 0] = matrix[1, 1] = self.masses.sum()
        apart = turns[:, None] - turns[None, :]
        matrix[2:, 2:] = self._pairs * np.cos(apart) + np.diag(self.spins)
        matrix[0, 2:] = matrix[2:, 0] = -sines * weights
        matrix[1, 2:] = matrix[2:, 1] = cosines * weights
        forces = self._friction(gait, rates, cosines, sines)
        squares = rates[2:] ** 2
        forces[0] += (cosines * weights) @ squares
        forces[1] += (sines * weights) @ squares
        forces[2:] -= (self._pairs * np.sin(apart)) @ squares
        wave = np.sin(2 * np.pi * gait.frequency * time - gait.lag * self.actuators)
        torques = gait.amplitude * wave - self.stiffness * np.diff(turns)
        torques -= self.damping * np.diff(rates[2:])
        forces[3:] += torques
        forces[2:-1] -= torques
        return np.concatenate([rates, np.linalg.solve(matrix, forces)])

    def _friction(self, gait: Gait, rates: Array, cosines: Array, sines: Array) -> Array:
        """Return the generalised forces of the friction at all feet."""
        ahead = cosines[self._links], sines[self._links]
        spins = rates[2:][self._links] * self._sides
        x = rates[0] - self._arms @ (sines * rates[2:]) - spins * ahead[0]
        y = rates[1] + self._arms @ (cosines * rates[2:]) - spins * ahead[1]
        load = gait.friction * self.masses.sum() * GRAVITY / len(self._links)
        speeds = np.sqrt(x * x + y * y + SMOOTHING**2)
        along = -load / speeds * gait.along * (x * ahead[0] + y * ahead[1])
        across = -load / speeds * (y * ahead[0] - x * ahead[1])
        x = along * ahead[0] - across * ahead[1]
        y = along * ahead[1] + across * ahead[0]
        moments = np.bincount(self._links, -along * self._sides, len(self.masses))
        turning: Array = (y @ self._arms) * cosines - (x @ self._arms) * sines + moments
        return np.concatenate([[x.sum(), y.sum()], turning])

    def _reach(self, links: Array, heights: Array) -> Array:
        """Return how far points on links are moved by each link's direction, shape (p, links)."""
        arms: Array = np.where(np.arange(len(self.lengths)) < links[:, None], self.lengths, 0.0)
        arms[np.arange(len(links)), links] = heights
        return arms


def _boxes(chain: Chain) -> list[tuple[int, Box, float]]:
    """Return all boxes of a chain: the number of the link, the box, its middle's height on it."""
    return [
        (number, shape.solid, shape.position[2])
        for number, link in enumerate(chain.links)
        for shape in link.shapes
        if isinstance(shape.solid, Box)
    ]


def _feet(chain: Chain) -> tuple[Array, Array]:
    """Return the links of both ends of every box, and their heights on these [m]."""
    feet = [
        (number, middle + end * box.size[2] / 2)
        for number, box, middle in _boxes(chain)
        for end in (-1, 1)
    ]
    links, heights = zip(*feet, strict=True)
    return np.array(links), np.array(heights)
