"""Notices that a run has diverged, by energy and speed: the numbers of one stay finite for long."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.springs import Array, Springs, largest_explicit_step

ANGLE_PER_STEP = math.pi  # rad; beyond, a joint's motion cannot be told from its alias
ENERGY_RATIO = 4.0  # to what was put in; an integrator at its accuracy limit stays well below 2
SMALL_ANGLE = 1e-3  # rad; deflections below it are never called divergence


class BodyEnergy:
    """The energy of one body's joints and springs against what start and actuation gave it."""

    def __init__(self, body: Body, springs: Springs, gravity: Sequence[float]) -> None:
        self.body = body
        self._springs = springs
        self._weight = geometry.norm((gravity[0], gravity[1], gravity[2]))
        self._masses = [link.inertial.mass for link in body.chain.links]
        self._reaches = _reaches(body)
        self._work = 0.0
        self._most_work = 0.0
        self._start: float | None = None
        self._last_angles: Array | None = None
        self._last_actuation: Array | None = None
        self._joint_energy: Array | None = None
        self.joint_rates: Array | None = None

    def update(
        self, angles: Array, rates: Array, actuation: Array, mass: Array
    ) -> tuple[float, float]:
        """Return the present energy and the most it may be, both in engine units.

        The bound is the energy at the start, the work of the actuation, and what gravity can
        give at most, with everything stretched out and falling over once.
        """
        momentum = mass @ rates
        deflection = angles - self._springs.neutral
        self._joint_energy = 0.5 * (
            np.abs(rates * momentum) + self._springs.stiffness * deflection**2
        )
        self.joint_rates = rates.copy()
        energy = 0.5 * float(rates @ momentum) + self._springs.energy(angles)
        if self._start is None or self._last_angles is None or self._last_actuation is None:
            self._start = energy + self._base_energy() + self._fall(self._reaches)
        else:
            mean = 0.5 * (actuation + self._last_actuation)
            self._work += float(mean @ (angles - self._last_angles))
            self._most_work = max(self._most_work, self._work)
        self._last_angles, self._last_actuation = angles.copy(), actuation.copy()
        return energy, self._start + self._most_work

    def fall_of_base(self, distance: float) -> float:
        """Return what gravity can give when the base has moved this far."""
        return self._weight * sum(self._masses) * distance

    def worst_joint(self) -> int:
        """Return the index of the joint with the largest share of the energy."""
        assert self._joint_energy is not None
        if not np.isfinite(self._joint_energy).all():
            return int(np.argmax(~np.isfinite(self._joint_energy)))
        return int(np.argmax(self._joint_energy))

    def floor(self) -> float:
        """Return an energy too small to speak of: every spring deflected by a small angle."""
        return float(0.5 * self._springs.stiffness.sum() * SMALL_ANGLE**2)

    def _fall(self, reaches: Sequence[float]) -> float:
        return self._weight * sum(
            2 * mass * reach for mass, reach in zip(self._masses, reaches, strict=True)
        )

    def _base_energy(self) -> float:
        speed = geometry.norm(self.body.start.linear_velocity)
        spin = geometry.norm(self.body.start.angular_velocity)
        return 0.5 * sum(
            link.inertial.mass * (speed + spin * reach) ** 2
            + max(link.inertial.inertia) * spin**2
            for reach, link in zip(self._reaches, self.body.chain.links, strict=True)
        )


def check(
    step: int,
    plan: Plan,
    energies: Sequence[BodyEnergy],
    totals: Sequence[tuple[float, float]],
    masses: Sequence[Array],
) -> None:
    """Raise SimulationDiverged if the bodies together have more energy than they can have.

    `totals` holds the (energy, bound) of every body; together, because contact moves energy from
    one to another. A single joint that turns too far in one step is refused as well.
    """
    energy = sum(total[0] for total in totals)
    bound = sum(total[1] for total in totals)
    floor = sum(one.floor() for one in energies)
    limit = ANGLE_PER_STEP / plan.time_step
    fast = [
        index
        for index, one in enumerate(energies)
        if one.joint_rates is not None and not float(np.abs(one.joint_rates).max()) < limit
    ]
    if not fast and energy <= ENERGY_RATIO * bound + floor:
        return
    if fast:
        index = fast[0]
        rates = energies[index].joint_rates
        assert rates is not None
        joint = int(np.argmax(np.abs(np.where(np.isfinite(rates), rates, np.inf))))
        reason = f"it turns {abs(rates[joint]) * plan.time_step:.3g} rad in one step"
    else:
        index = max(range(len(totals)), key=lambda i: _rank(totals[i][0]))
        joint = energies[index].worst_joint()
        reason = f"the energy is {energy / max(bound, floor):.3g} times what was put in"
    body = energies[index].body
    name = f"{body.name}.{body.chain.joints[joint].name}"
    hint = _advice(plan, body, masses[index])
    raise SimulationDiverged(step, step * plan.time_step, name, reason, hint)


def _rank(energy: float) -> float:
    return energy if math.isfinite(energy) else math.inf


def _advice(plan: Plan, body: Body, mass: Array) -> str:
    if plan.integrator == "explicit":
        stiffness = np.array([joint.stiffness for joint in body.chain.joints])
        damping = [joint.damping for joint in body.chain.joints]
        largest = largest_explicit_step(mass, stiffness, damping)
        return (
            f"the explicit integrator is stable below a step of {largest:.3g} s here; "
            "use integrator: implicit, or such a step"
        )
    if plan.integrator == "implicit":
        return f"try half the step, --time-step {plan.time_step / 2:g}, or integrator: euler"
    return f"try half the step, --time-step {plan.time_step / 2:g}"


def _reaches(body: Body) -> list[float]:
    """Return how far each link's centre of mass can be from the base frame's origin."""
    along = 0.0
    reaches = []
    for index, link in enumerate(body.chain.links):
        if index > 0:
            along += geometry.norm(body.chain.joints[index - 1].origin)
        reaches.append(along + geometry.norm(link.inertial.centre))
    return reaches
