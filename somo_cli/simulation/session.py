"""A plan that is being simulated: its bodies, their monitors, and the step reached."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import cast

from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.interface import World, WorldKinematicObject, WorldPrescribedBody
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.integrator.contact_prediction import PredictionCount
from somo_cli.simulation.integrator.energy_bound import ObjectEnergyBound
from somo_cli.simulation.integrator.fixed_base import FixedBase
from somo_cli.simulation.integrator.floating_base import FloatingBase
from somo_cli.simulation.integrator.half_step_start import begin
from somo_cli.simulation.integrator.kinematic_object import KinematicObjectStepper
from somo_cli.simulation.integrator.prescribed_base import PrescribedBase
from somo_cli.simulation.loop import SimulationLoop
from somo_cli.simulation.monitoring.contact_events import ContactEvent, ContactMonitor
from somo_cli.simulation.monitoring.contact_findings import ContactFindings
from somo_cli.simulation.monitoring.divergence import DivergenceMonitor
from somo_cli.simulation.monitoring.findings import Finding, in_order
from somo_cli.simulation.monitoring.object_motion import motions_of_objects
from somo_cli.simulation.monitoring.penetration import Penetration
from somo_cli.simulation.monitoring.unpredicted_contact import unpredicted_contact
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.recording.row_assembler import RowAssembler, RowWriter
from somo_cli.simulation.schedule import MonitoringSchedule


class Session:
    """Steps a plan in a world from its start.

    The trajectory does not depend on how many steps are taken at once. With `write` the rows of
    the plan are recorded and passed on many at a time, shape (rows, columns), in SI; with
    `on_event` contacts are listed in every step, and each change of them is passed on.
    """

    def __init__(
        self,
        plan: Plan,
        world: World,
        write: RowWriter | None = None,
        on_event: Callable[[ContactEvent], None] | None = None,
    ) -> None:
        self.plan = plan
        self.world = world
        self.step = 0
        """The step whose state the bodies have."""
        self.steppers = [_body_stepper(plan, world, number) for number in range(len(plan.bodies))]
        kinematic = _kinematic_objects(plan, world)
        begin(plan, world, self.steppers, kinematic)
        motions = motions_of_objects(plan, world)
        self.divergence = DivergenceMonitor(
            plan, self.steppers, _input_by_objects(plan, world, kinematic), motions
        )
        self.assembler = (
            None
            if write is None
            else RowAssembler(plan, world, self.steppers, self.divergence, write)
        )
        contact_monitor = None if on_event is None else ContactMonitor(plan.time_step, on_event)
        self._loop = SimulationLoop(
            plan, world, self.steppers, kinematic, self.assembler, contact_monitor
        )
        self._contact = (
            ContactFindings(
                plan,
                world,
                self.steppers,
                motions,
                lambda: sum(one.energy_so_far for one in kinematic),
            )
            if plan.can_touch
            else None
        )
        self._is_driven = False  # since the last check
        self.schedule = MonitoringSchedule(plan)

    @property
    def time(self) -> float:
        """The time of the present state [s]."""
        return self.step * self.plan.time_step

    @property
    def deepest(self) -> Penetration | None:
        """The deepest penetration so far, None if there was none."""
        return None if self._contact is None else self._contact.penetration.deepest

    def findings(self) -> tuple[Finding, ...]:
        """Return the findings about contact so far, in order of time."""
        if self._contact is None:
            return ()
        unpredicted = unpredicted_contact(self.plan, self.prediction_count)
        return in_order([*self._contact.found(), *([unpredicted] if unpredicted else [])])

    def note_drive(self) -> None:
        """Record that the user has changed the torques or loads on the bodies."""
        self._is_driven = True

    @property
    def prediction_count(self) -> PredictionCount:
        """The number of steps with contact so far, and of those in which it was not predicted."""
        return self._loop.prediction_count

    def actuate(self) -> None:
        """Set the torques and loads of the step that starts at the present state."""
        self._loop.actuate(self.step)

    def monitor(self, is_last: bool = False) -> None:
        """Run the checks that are due at the present state, or those of the last step.

        Raises SimulationDiverged.
        """
        if not (is_last or self.schedule.is_pause(self.step)):
            return  # a check here would make the trajectory depend on where the user paused
        if is_last or self.schedule.checks_motion(self.step):
            self.divergence.update(self.step)
        contact = self._contact
        if contact is not None:
            contact.penetration.update(self.step)
            if self.schedule.checks_motion(self.step):
                contact.update(self.step, self._is_driven)
                self._is_driven = False
            if self.schedule.checks_contact(self.step):  # at the last step it changes nothing
                self.world.adapt_solver_iterations()

    def advance(self, until: int) -> None:
        """Advance to step `until`, at most to the next check. Call `actuate` first.

        While the contact monitor needs every step, it advances by one step only.
        """
        contact = self._contact
        if contact is not None and contact.wants_every_step:
            until = self.step + 1
        self._loop.advance(self.step, until)
        self.step = until
        if contact is not None:
            self._is_driven |= not self._loop.is_steady
            if contact.wants_every_step:
                contact.sample()

    def record_last(self) -> None:
        """Record the present state as the last row.

        The engine may step once more, for velocities half a step later.
        """
        self._loop.record_last(self.step)


def _body_stepper(plan: Plan, world: World, number: int) -> BodyStepper:
    body, world_body = plan.bodies[number], world.bodies[number]
    if body.path is not None:
        moved = cast(WorldPrescribedBody, world_body)
        base: FixedBase = PrescribedBase(
            plan, body, moved, body.path, _contact_force_on(world, number)
        )
    elif body.base == "free":
        base = FloatingBase(plan, body, world_body)
    else:
        base = FixedBase(body, world_body)
    return BodyStepper(plan, body, world_body, base)


def _kinematic_objects(plan: Plan, world: World) -> list[KinematicObjectStepper]:
    return [
        KinematicObjectStepper(
            plan,
            planned,
            planned.path,
            cast(WorldKinematicObject, world_object),
            _contact_force_on(world, number),
        )
        for number, (planned, world_object) in enumerate(
            zip(plan.objects, world.objects, strict=True), start=len(plan.bodies)
        )
        if planned.path is not None
    ]


def _contact_force_on(world: World, number: int) -> Callable[[], Sequence[float]]:
    """Return a reader of the contact force on a body or object, and of its sum of normal forces."""
    return lambda: contacts.total_force(contacts.contacts_on(world.contact_points(), number))


def _input_by_objects(
    plan: Plan, world: World, kinematic: Sequence[KinematicObjectStepper]
) -> Callable[[], float]:
    """Return a reader of the upper bound on the energy that objects have added so far."""
    if not plan.objects:
        return lambda: 0.0
    of_objects = ObjectEnergyBound(plan, world.objects)
    return lambda: of_objects.energy_bound() + sum(one.energy_bound() for one in kinematic)
