"""Finds energy that contact adds: rigid and passive surfaces only ever take energy away.

The ledger of a scene is D = E - W: the energy of motion, springs, gravity and soft surfaces, less
the work of actuation, loads and prescribed motion. Friction, dampers and impacts make it fall, and
nothing makes it rise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.monitoring.findings import Finding, half_step_hint
from somo_cli.simulation.monitoring.object_motion import ObjectMotion
from somo_cli.simulation.monitoring.penetration import PenetrationMonitor
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of

LARGEST_GROWTH = 0.05
"""Of the most energy in motion, springs and work so far. Velocities are half a step older than
poses, so the ledger of a scene that is right swings by about a hundredth at a fast step."""
NEGLIGIBLE_LIFT = 1e-3  # of the thickest part: to be pushed out as far is not called a gain


@dataclass(frozen=True, slots=True)
class Ledger:
    """The energy of a whole scene at an instant [engine units].

    `mobile` is what is in motion and springs, `potential` that of gravity, `work` what was put in,
    or an upper bound of it.
    """

    mobile: float
    potential: float
    work: float


class EnergyGrowthMonitor:
    """Compares the ledger of a scene with the least that it was so far."""

    def __init__(self, plan: Plan, floor: float, read: Callable[[], Ledger]) -> None:
        self._plan = plan
        self._floor = floor
        self._read = read
        self._least = float("inf")
        self._scale = 0.0
        self.finding: Finding | None = None

    def update(self, time: float) -> None:
        """Read the ledger at a time [s]."""
        if self.finding is not None:
            return
        now = self._read()
        balance = now.mobile + now.potential - now.work
        self._scale = max(self._scale, now.mobile, abs(now.work))
        self._least = min(self._least, balance)
        growth = balance - self._least
        if growth > LARGEST_GROWTH * self._scale + self._floor:
            self.finding = self._finding(time, growth)

    def _finding(self, time: float, growth: float) -> Finding:
        joule = unit_factors_of(self._plan).torque
        growth, scale = growth / joule, self._scale / joule
        return Finding(
            "contact-energy",
            time,
            (),
            f"by {time:.4g} s contact has added {growth:.3g} J to bodies and objects, where at "
            f"most {scale:.3g} J were in motion, in springs or put in; contact takes energy away",
            half_step_hint(self._plan.time_step),
            (("energy_gained_j", growth), ("energy_scale_j", scale)),
        )


def ledger_reader(
    steppers: Sequence[BodyStepper],
    objects: Sequence[ObjectMotion],
    gravity: Vector,
    soft_energy: Callable[[], float],
    motion_work: Callable[[], float],
) -> Callable[[], Ledger]:
    """Return a function that reads the ledger of a scene whose motion was just measured.

    `soft_energy` returns what soft surfaces have taken up, and `motion_work` an upper bound on the
    work that moved objects have done so far.
    """
    gx, gy, gz = gravity

    def read() -> Ledger:
        mobile, potential = soft_energy(), 0.0
        work = motion_work()
        for stepper in steppers:
            mobile += stepper.energy.present
            potential += _gravity_energy(stepper, gravity)
            work += stepper.energy.work
        for one in objects:
            mobile += one.energy()
            x, y, z = one.world_object.centre()
            potential -= one.mass * (x * gx + y * gy + z * gz)
        return Ledger(mobile, potential, work)

    return read


def has_soft_surfaces(plan: Plan) -> bool:
    """Whether a surface of the scene has a contact stiffness."""
    surfaces = [*plan.surfaces, *([] if plan.ground is None else [plan.ground.surface])]
    return any(one.compliance is not None for one in surfaces)


def soft_energy_reader(
    plan: Plan, world: World, penetration: PenetrationMonitor
) -> Callable[[], float]:
    """Return a function that returns the energy in soft surfaces [engine units]."""
    if not has_soft_surfaces(plan):
        return lambda: 0.0
    reader = world.contact_reader()

    def read() -> float:
        energy = 0.0
        for first, second, depth in penetration.last:
            compliance = reader.pair((first, second)).compliance
            if compliance is not None:
                energy += 0.5 * compliance[0] * depth * depth
        return energy

    return read


def _gravity_energy(stepper: BodyStepper, gravity: Vector) -> float:
    """Return the energy of a body in gravity; in the frame of its base, if that is moved."""
    body, dynamics = stepper.body, stepper.dynamics()
    base = stepper.world_body.base_pose() if body.has_moving_base else body.start.pose
    energy = dynamics.at(stepper.law.angles, base).gravity_energy(gravity)
    if body.path is None:
        return energy
    (x, y, z), (gx, gy, gz) = base.position, gravity
    return energy + float(dynamics.masses.sum()) * (x * gx + y * gy + z * gz)
