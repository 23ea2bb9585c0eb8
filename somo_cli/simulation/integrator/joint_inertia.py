"""The joint-space inertia of one body: refreshed once its joints have moved far enough."""

from __future__ import annotations

import math

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.engine.interface import WorldBody
from somo_cli.simulation.integrator.implicit_law import SpringDamperLaw
from somo_cli.simulation.integrator.joint_limits import JointLimits
from somo_cli.simulation.integrator.refresh_policy import RefreshPolicy

COEFFICIENT_RATIO = 4.0  # D + N and B are refreshed after this many times the joint motion of M


class JointInertia:
    """Keeps M of a body, and the law that depends on it, as fresh as the policy asks for."""

    def __init__(
        self,
        world_body: WorldBody,
        law: SpringDamperLaw,
        limits: JointLimits,
        policy: RefreshPolicy,
    ) -> None:
        self.matrix: Array = np.zeros((0, 0))
        """The inertia M, shape (n, n); a new array each time."""
        self._world_body = world_body
        self._law = law
        self._limits = limits
        self._policy = policy
        self._angles: Array = np.zeros(0)
        # rad, since the refresh: the root of the sum of squares over the joints
        self._moved = 0.0
        self._clearance = math.nan  # rad, at the refresh, to the nearest limit; NaN until needed
        self._coefficient_angles: Array = np.full(len(law.angles), math.inf)

    def refresh_if_moved(self) -> None:
        """Refresh the inertia if the joints have moved too far since the last time."""
        moved = self._law.angles - self._angles
        self._moved = math.sqrt(moved.dot(moved))
        if self._moved > self._policy.refresh_angle:
            self.refresh()

    def refresh(self) -> None:
        """Refresh the inertia for the present angles."""
        angles = self._angles = self._law.angles.copy()
        self._moved, self._clearance = 0.0, math.nan
        self.matrix = self._world_body.mass_matrix(angles.tolist())
        moved = angles - self._coefficient_angles
        farthest = COEFFICIENT_RATIO * self._policy.refresh_angle
        refreshes_implicit = moved.dot(moved) > farthest**2
        if refreshes_implicit:
            self._coefficient_angles = angles
        self._law.refresh(self.matrix, refreshes_implicit)

    def clearance(self, enough: float) -> float:
        """Return the least distance of a joint from its limit [rad], exact only below `enough`."""
        if math.isnan(self._clearance):
            self._clearance = self._limits.clearance(self._angles)
        # no joint has moved farther than the root of the sum of squares
        clearance = self._clearance - self._moved
        return clearance if clearance >= enough else self._limits.clearance(self._law.angles)
