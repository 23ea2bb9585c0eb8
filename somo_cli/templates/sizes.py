"""Sizes of a body to start from, and what follows from them: masses, stiffnesses, damping."""

from __future__ import annotations

import math
from dataclasses import dataclass

DAMPING_RATIO = 0.05  # of the lowest mode, for want of a measurement

_FIRST_MODE = 3.516  # ω L² sqrt(ρ A / (E I)) of a clamped-free beam: Blevins (1979), table 8-1


@dataclass(frozen=True, slots=True)
class Sizes:
    """A straight beam along z: length, width along x, depth along y [m]; Pa, kg/m³.

    It is cut into `segments` links; with `axes` 2 the joints take turns about x and y.
    """

    length: float
    width: float
    depth: float
    segments: int
    modulus: float
    density: float
    axes: int = 2

    @property
    def segment(self) -> float:
        """The length of a segment [m]."""
        return self.length / self.segments

    @property
    def segment_mass(self) -> float:
        """The mass of a segment [kg]."""
        return self.density * self.width * self.depth * self.segment

    @property
    def span(self) -> float:
        """The length of beam that a joint stands for [m]."""
        return self.axes * self.segment

    def second_moment(self, axis: str) -> float:
        """Return the second moment of the section for bending about x or y [m⁴]."""
        across, along = (self.width, self.depth) if axis == "x" else (self.depth, self.width)
        return across * along**3 / 12

    def stiffness(self, axis: str) -> float:
        """Return the stiffness of a joint about x or y [N·m/rad], E I over its length of beam."""
        return self.modulus * self.second_moment(axis) / self.span

    def damping(self, axis: str) -> float:
        """Return the damping of a joint [N·m·s/rad] for the damping ratio of the lowest mode."""
        line = self.density * self.width * self.depth
        bending = self.modulus * self.second_moment(axis)
        frequency = _FIRST_MODE * math.sqrt(bending / line) / self.length**2
        return self.stiffness(axis) * 2 * DAMPING_RATIO / frequency

    def torque(self, bend: float) -> float:
        """Return the torque in each joint about x [N·m] that bends the whole by so much [rad]."""
        return self.stiffness("x") * bend * self.span / self.length


SILICONE = 0.5e6, 1070.0
"""A soft silicone: modulus [Pa] and density [kg/m³]."""
FINGER = Sizes(0.1, 0.023, 0.017, 10, *SILICONE)
ARM_ACTUATORS = 5
SNAKE_ACTUATORS = 8
ARM = Sizes(0.75, 0.04, 0.04, 50, *SILICONE)
SNAKE = Sizes(0.8, 0.03, 0.04, 16, *SILICONE, axes=1)
