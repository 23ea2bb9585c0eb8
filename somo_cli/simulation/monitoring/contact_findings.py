"""All that monitors contact in a run, and what it found."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from somo_cli.manipulator import geometry
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.refresh_policy import MONITORING_INTERVAL
from somo_cli.simulation.monitoring.contact_shaking import ContactShakingMonitor
from somo_cli.simulation.monitoring.energy_growth import (
    NEGLIGIBLE_LIFT,
    EnergyGrowthMonitor,
    has_soft_surfaces,
    ledger_reader,
    soft_energy_reader,
)
from somo_cli.simulation.monitoring.findings import Finding, in_order
from somo_cli.simulation.monitoring.missed_contact import MissedContactMonitor
from somo_cli.simulation.monitoring.object_motion import ObjectMotion
from somo_cli.simulation.monitoring.penetration import PenetrationMonitor
from somo_cli.simulation.plan.model import Plan

TIME_BETWEEN_LEDGERS = 0.064  # s; a ledger costs as much as a few steps


class ContactFindings:
    """Monitors contact while bodies move; it changes nothing.

    `motion_work` returns an upper bound on the work that moved objects have done so far.
    """

    def __init__(
        self,
        plan: Plan,
        world: World,
        steppers: Sequence[BodyStepper],
        objects: Sequence[ObjectMotion],
        motion_work: Callable[[], float],
    ) -> None:
        self._plan = plan
        self._world = world
        self.penetration = PenetrationMonitor(plan, world)
        self._shaking = ContactShakingMonitor(plan)
        self._missed = MissedContactMonitor(plan, world, steppers)
        soft_energy = soft_energy_reader(plan, world, self.penetration)
        ledger = ledger_reader(steppers, objects, plan.gravity, soft_energy, motion_work)
        self._energy = EnergyGrowthMonitor(plan, _negligible_energy(plan), ledger)
        checks = round(TIME_BETWEEN_LEDGERS / (MONITORING_INTERVAL * plan.time_step))
        if has_soft_surfaces(plan):
            checks = 1  # a rebound takes milliseconds
        self._ledger_interval = MONITORING_INTERVAL * max(1, checks)

    @property
    def wants_every_step(self) -> bool:
        """Whether `sample` is to be called after each of the coming steps."""
        return self._shaking.wants_every_step

    def update(self, step: int, is_driven: bool) -> None:
        """Check at a step in which motion was just measured.

        It is driven if actuation, loads or a prescribed motion have changed since the last check.
        """
        time = step * self._plan.time_step
        if step:
            self._shaking.update(time, self._world.normal_forces(), is_driven)
        self._missed.update(time)
        if step % self._ledger_interval == 0:
            self._energy.update(time)

    def sample(self) -> None:
        """Sample the contact of one step."""
        self._shaking.sample(self._world.normal_forces())

    def found(self) -> tuple[Finding, ...]:
        """Return what was found so far, in order of time."""
        found = [*self._shaking.findings.values(), *self._missed.findings.values()]
        found += [one for one in (self._energy.finding, self.penetration.finding()) if one]
        return in_order(found)


def _negligible_energy(plan: Plan) -> float:
    """Return the energy that pushes the whole scene out of a slight overlap."""
    weight = geometry.norm(plan.gravity)
    links = [link for body in plan.bodies for link in body.chain.links]
    links += [one.rigid_object.chain.links[0] for one in plan.objects]
    mass = sum(link.inertial.mass for link in links)
    sizes = [shape.solid.smallest_extent for link in links for shape in link.shapes]
    return weight * mass * NEGLIGIBLE_LIFT * max(sizes, default=0.0)
