"""Upper bound on the energy that a prescribed motion has added.

The divergence monitor must neither take that energy for divergence nor overlook divergence for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import max_distances
from somo_cli.simulation.plan.model import Plan


class MotionWorkBound:
    """Bounds on the energy that one prescribed frame has added since the last call; engine units.

    They depend on the largest distance of a point that moves with the frame from its origin.
    """

    def __init__(self, plan: Plan, chain: Chain) -> None:
        self.can_touch = plan.can_touch
        self._step = plan.time_step
        self._weight = geometry.norm(plan.gravity)
        self._reach = _reach(chain)
        self._mass = sum(link.inertial.mass for link in chain.links[1:])
        self._all_mass = sum(
            link.inertial.mass for body in plan.bodies for link in body.chain.links
        ) + sum(
            planned.rigid_object.chain.links[0].inertial.mass
            for planned in plan.objects
            if not planned.rigid_object.has_prescribed_pose
        )
        self._velocity_change = self._rotation = self._path_length = self._max_speed = 0.0
        self._was_in_contact = False

    def advance(self, before: Array, after: Array) -> None:
        """Advance by a step: velocities of the last and the next, shape (6,), angular first."""
        spin = float(np.linalg.norm(after[:3]))
        speed = float(np.linalg.norm(after[3:])) + self._reach * spin
        change = after - before
        self._velocity_change += float(np.linalg.norm(change[3:]))
        self._velocity_change += self._reach * float(np.linalg.norm(change[:3]))
        self._velocity_change += self._reach * spin**2 * self._step
        self._rotation += spin * self._step
        self._path_length += speed * self._step
        self._max_speed = max(self._max_speed, speed)

    def frame_work(self, energy: float) -> float:
        """Return the most work that inertia and gravity can have done in the prescribed frame.

        `energy` is the largest energy of the joints in that frame meanwhile. With speeds v_i in the
        frame and no point accelerated by more than a, the power is at most sum m_i a v_i <= a
        sqrt(2 m E):
        Cauchy and Schwarz. Coriolis forces do no work.
        """
        work = self._velocity_change * math.sqrt(2 * self._mass * energy)
        work += 0.5 * self._mass * self._velocity_change**2
        gravity_work = self._weight * self._mass * self._reach * self._rotation
        self._velocity_change = self._rotation = 0.0
        return work + gravity_work

    def contact_work(self, force: Sequence[float]) -> float:
        """Return the most work that the frame can have done by contact.

        `force` has three components and the sum of normal forces. The work is force times path
        length. Whenever contact begins, it is also the energy of all masses
        thrown ahead at twice the speed, since an impact may fall between two checks.
        """
        x, y, z, normal = force
        contact_force = math.hypot(x, y, z) + normal
        work = contact_force * self._path_length
        if contact_force > 0 and not self._was_in_contact:
            work += 2 * self._all_mass * self._max_speed**2
        self._was_in_contact = contact_force > 0
        self._path_length = 0.0
        return work


def _reach(chain: Chain) -> float:
    """Return about how far from the base frame's origin a point of the chain can be."""
    far = 0.0
    for distance, link in zip(max_distances(chain), chain.links, strict=True):
        xx, _, _, yy, _, zz = link.inertial.inertia
        # half the diagonal of a homogeneous box; no less for a cylinder or a sphere
        size = math.sqrt(1.5 * (xx + yy + zz) / link.inertial.mass)
        far = max(far, distance + geometry.norm(link.inertial.centre) + size)
    return far
