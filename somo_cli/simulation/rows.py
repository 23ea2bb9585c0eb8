"""Rows of the CSV out of a world in motion: what the columns need is read, and nothing else."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Kinematics, Pose
from somo_cli.simulation import columns, thing_columns
from somo_cli.simulation.columns import Group, State, ThingGroup
from somo_cli.simulation.contact_columns import others_of
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.runner import Runner
from somo_cli.simulation.thing_columns import ThingState
from somo_cli.simulation.touching import Touch
from somo_cli.simulation.turning import TurnCounter
from somo_cli.simulation.units import Units, units_of
from somo_cli.simulation.world import World, WorldThing

_RATES = frozenset({"joint_rates", "energy"})
_PLACED = frozenset({"pose", "angles"})
_TOUCHED = frozenset({"contact_force", "contact_pairs", "link_contact_forces"})


class Rows:
    """Makes the rows of a plan, each in two moves: `take` at its step, `row` a step later.

    A step later, because with the implicit law velocities live at half steps, and a row has the
    mean of two; `needs_next_step` says whether any of the columns asks for that.
    """

    def __init__(self, plan: Plan, world: World, runners: Sequence[Runner]) -> None:
        self._world = world
        units = units_of(plan)
        groups, of_things = columns.groups(plan), columns.thing_groups(plan)
        bodies = [
            _BodyRows(plan, number, runner, own, units)
            for number, runner in enumerate(runners)
            if (own := [one for one in groups if one.body == number])
        ]
        self._things = [
            _ThingRows(plan, index, thing, of_one, units)
            for index, thing in enumerate(world.things)
            if (of_one := [one for one in of_things if one.thing == index])
        ]
        self._parts: list[_BodyRows | _ThingRows] = [*bodies, *self._things]
        kinds = {group.quantity for group in groups} | {group.reading for group in of_things}
        keeps_all = plan.keeps_everything
        self._has_touches = keeps_all or not _TOUCHED.isdisjoint(kinds)
        self.needs_next_step = plan.integrator == "implicit" and (
            keeps_all or not (_RATES | {"velocity"}).isdisjoint(kinds)
        )
        self._is_counting = "angles" in kinds
        self._time_step = plan.time_step
        self._step = 0

    def look(self) -> None:
        """Count the turns of objects; at looks, so that it does not matter where rows fall."""
        if self._is_counting:
            for thing in self._things:
                thing.look()

    def take(self, step: int) -> None:
        """Take the present state for the row of a step."""
        touches = self._world.touches() if self._has_touches and step > 0 else ()
        self._step = step
        for part in self._parts:
            part.take(touches)

    def row(self) -> list[float]:
        """Return the row in SI, in the order of the header."""
        values = [float(f"{self._step * self._time_step:.12g}")]  # 0.018, not 0.018000000000000002
        for part in self._parts:
            if self.needs_next_step:
                part.centre()
            part.extend(values)
        return values


class _BodyRows:
    """The columns of one manipulator."""

    def __init__(
        self, plan: Plan, number: int, runner: Runner, groups: Sequence[Group], units: Units
    ) -> None:
        self._runner = runner
        self._gravity = plan.gravity
        self._number, self._others = number, others_of(plan, number)
        self._units = units
        kinds = {group.quantity for group in groups}
        can_move = runner.body.base != "static"
        # a base that can move is read at every row's step, any other once
        is_base_told = not kinds.isdisjoint(columns.OF_BASE)
        self._has_base = can_move and is_base_told
        self._base = runner.world_body.base_pose() if is_base_told else Pose()
        self._has_velocity = can_move and "energy" in kinds
        self._has_rates = not _RATES.isdisjoint(kinds)
        self._kinematics = Kinematics(runner.body.chain)
        self._readings = [(columns.READINGS[one.quantity], one.kept) for one in groups]

    def take(self, touches: Sequence[Touch]) -> None:
        runner, law = self._runner, self._runner.law
        if self._has_base:
            self._base = runner.world_body.base_pose()
        self._state = State(
            runner.body,
            law.angles.tolist(),
            law.rates.tolist(),
            runner.actuation.tolist(),
            self._base,
            runner.world_body.base_velocity() if self._has_velocity else _STILL,
            self._gravity,
            self._kinematics,
            runner.dynamics,
            self._number,
            self._others,
            touches,
        )

    def centre(self) -> None:
        """Replace rates half a step before the instant by the mean with those half a step after."""
        if self._has_rates:
            state, runner = self._state, self._runner
            state.rates = (0.5 * (state.rates + runner.law.rates)).tolist()
            if self._has_velocity:
                after = runner.world_body.base_velocity()
                state.base_velocity = _mean(state.base_velocity, after)

    def extend(self, values: list[float]) -> None:
        for read, kept in self._readings:
            values.extend(kept.of(read(self._state, self._units)))


class _ThingRows:
    """The columns of one object."""

    def __init__(
        self, plan: Plan, index: int, thing: WorldThing, groups: Sequence[ThingGroup], units: Units
    ) -> None:
        self._thing = thing
        self._units = units
        number = len(plan.bodies) + index
        kinds = {group.reading for group in groups}
        self._has_pose = not _PLACED.isdisjoint(kinds)
        self._has_velocity = "velocity" in kinds
        self._turns = TurnCounter(thing.pose().rotation) if "angles" in kinds else None
        self._readings = [(thing_columns.READINGS[one.reading], one.kept) for one in groups]
        self._state = ThingState(number, others_of(plan, number))

    def look(self) -> None:
        if self._turns is not None:
            self._turns.look(self._thing.pose().rotation)

    def take(self, touches: Sequence[Touch]) -> None:
        thing, state = self._thing, self._state
        state.touches = touches
        if self._has_pose:
            state.pose = thing.pose()
        if self._turns is not None:
            state.turned = self._turns.at(state.pose.rotation)
        if self._has_velocity:
            state.velocity = thing.velocity()

    def centre(self) -> None:
        if self._has_velocity:
            self._state.velocity = _mean(self._state.velocity, self._thing.velocity())

    def extend(self, values: list[float]) -> None:
        for read, kept in self._readings:
            values.extend(kept.of(read(self._state, self._units)))


_STILL = (geometry.ZERO, geometry.ZERO)


def _mean(before: tuple[Vector, Vector], after: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    (ax, ay, az), (bx, by, bz) = (geometry.add(*pair) for pair in zip(before, after, strict=True))
    return (0.5 * ax, 0.5 * ay, 0.5 * az), (0.5 * bx, 0.5 * by, 0.5 * bz)
