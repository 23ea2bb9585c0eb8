"""The columns of the CSV: their names, and their values in SI from the state of a body."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Frame, Kinematics, Pose
from somo_cli.simulation import contact_columns, thing_columns
from somo_cli.simulation.contact_columns import LOAD, TOTAL, pair_names
from somo_cli.simulation.dynamics import ChainDynamics
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.scene import Quantity, tips
from somo_cli.simulation.selection import Kept, kept
from somo_cli.simulation.things import Reading
from somo_cli.simulation.touching import Touch
from somo_cli.simulation.units import Units

_XYZ = ("x_m", "y_m", "z_m")
_XYZW = ("qx", "qy", "qz", "qw")
_ENERGIES = ("kinetic_j", "elastic_j", "gravity_j")
_TURN_AT = {"base_pose": 3, "pose": 3, "link_orientations": 0}
"""At which column of a kind unit quaternions begin, four columns each."""

OF_BASE = frozenset({"link_positions", "link_orientations", "base_pose", "tip_position", "energy"})
"""The quantities that ask where the base is."""


@dataclass
class State:
    """One body at one instant, in engine units: angles, rates and actuation by joint.

    `base_pose` is the pose of the base's URDF frame in the world, if a column needs it, and
    `base_velocity` holds the velocity of the base's centre of mass and its spin, in the world;
    `number` is that of the body, and `touches` all that touched anything in the step before.
    """

    body: Body
    angles: Sequence[float]
    rates: Sequence[float]
    actuation: Sequence[float]
    base_pose: Pose
    base_velocity: tuple[Vector, Vector]
    gravity: Vector
    kinematics: Kinematics
    dynamics: Callable[[], ChainDynamics]
    number: int = 0
    others: Sequence[int] = ()
    touches: Sequence[Touch] = ()
    _frames: Sequence[Frame] | None = field(default=None, init=False)

    @property
    def frames(self) -> Sequence[Frame]:
        """Every link frame in the world, root first."""
        if self._frames is None:
            base = self.base_pose
            self._frames = self.kinematics.frames(self.angles, (base.position, base.rotation))
        return self._frames


Reader: TypeAlias = Callable[[State, Units], Sequence[float]]


@dataclass(frozen=True, slots=True)
class Group:
    """The columns [first, last) of one quantity of one body, all of one unit."""

    body: int
    quantity: Quantity
    first: int
    last: int
    kept: Kept


@dataclass(frozen=True, slots=True)
class ThingGroup:
    """The columns [first, last) of one reading of one object."""

    thing: int
    reading: Reading
    first: int
    last: int
    kept: Kept


def header(plan: Plan) -> list[str]:
    """Return the name of every column, time first; each name ends with its unit."""
    chosen = [group.kept for group in groups(plan)] + [one.kept for one in thing_groups(plan)]
    return ["time_s", *(name for one in chosen for name in one.names)]


def groups(plan: Plan) -> list[Group]:
    """Return what the columns of manipulators are, in the order of the header."""
    found: list[Group] = []
    first = 1
    for number, body in enumerate(plan.bodies):
        for quantity in plan.columns:
            own = (
                pair_names(plan, number) if quantity == "contact_pairs" else _names(body, quantity)
            )
            chosen = kept(plan.only, [f"{body.name}.{name}" for name in own])
            if chosen.places:
                last = first + len(chosen.places)
                found.append(Group(number, quantity, first, last, chosen))
                first = last
    return found


def thing_groups(plan: Plan) -> list[ThingGroup]:
    """Return what the columns of objects are, behind those of manipulators."""
    found: list[ThingGroup] = []
    first = max((group.last for group in groups(plan)), default=1)
    for index, planned in enumerate(plan.things):
        for reading in plan.of_things:
            own = thing_columns.names(plan, index, reading)
            chosen = kept(plan.only, [f"{planned.thing.name}.{name}" for name in own])
            if chosen.places:
                last = first + len(chosen.places)
                found.append(ThingGroup(index, reading, first, last, chosen))
                first = last
    return found


def turns(plan: Plan) -> Iterator[tuple[int, ...]]:
    """Yield the columns of every unit quaternion, or what is recorded of it; time is column 0."""
    kinds: list[tuple[str, int, Kept]] = [
        *((one.quantity, one.first, one.kept) for one in groups(plan)),
        *((one.reading, one.first, one.kept) for one in thing_groups(plan)),
    ]
    for kind, first, chosen in kinds:
        if kind not in _TURN_AT:
            continue
        by_turn: dict[int, list[int]] = {}
        for column, place in enumerate(chosen.places, start=first):
            if place >= _TURN_AT[kind]:
                by_turn.setdefault((place - _TURN_AT[kind]) // 4, []).append(column)
        yield from map(tuple, by_turn.values())


def base_pose_names(body: Body) -> list[str]:
    """Return the columns that tell where the base of a body is: position, quaternion."""
    return [f"{body.name}.{name}" for name in _names(body, "base_pose")]


def _names(body: Body, quantity: Quantity) -> list[str]:
    joints = [joint.name for joint in body.chain.joints]
    links = [link.name for link in body.chain.links]
    if quantity == "actuation":
        return [f"{name}.torque_nm" for name in _names_of_channels(body)]
    suffixes: dict[Quantity, tuple[list[str], tuple[str, ...]]] = {
        "joint_angles": (joints, ("angle_rad",)),
        "joint_rates": (joints, ("rate_rad_per_s",)),
        "spring_torques": (joints, ("spring_torque_nm",)),
        "curvatures": (joints, ("curvature_per_m",)),
        "link_positions": (links, _XYZ),
        "link_orientations": (links, _XYZW),
        "base_pose": (["base_pose"], _XYZ + _XYZW),
        "tip_position": (list(tips(body.chain)), _XYZ),
        "energy": (["energy"], _ENERGIES),
        "contact_force": (["contact"], TOTAL),
        "link_contact_forces": ([f"{link}.contact" for link in links], LOAD),
    }
    owners, units = suffixes[quantity]
    return [f"{owner}.{unit}" for owner in owners for unit in units]


def _channels(body: Body) -> list[tuple[int, int]]:
    return sorted({(joint.actuator, joint.channel) for joint in body.chain.joints})


def _names_of_channels(body: Body) -> list[str]:
    names: dict[tuple[int, int], str] = {}
    for joint in body.chain.joints:
        limb = body.chain.backbone_of(joint)
        number = joint.actuator - limb.first_actuator
        name = f"{limb.prefix}actuator_{number}_axis_{joint.channel}"
        names[joint.actuator, joint.channel] = name
    return [names[channel] for channel in _channels(body)]


def _angles(state: State, units: Units) -> Sequence[float]:
    return state.angles


def _rates(state: State, units: Units) -> Sequence[float]:
    return state.rates


def _spring_torques(state: State, units: Units) -> Sequence[float]:
    torque = units.torque
    return [
        -joint.stiffness * (angle - joint.neutral_position) / torque
        for joint, angle in zip(state.body.chain.joints, state.angles, strict=True)
    ]


def _actuation(state: State, units: Units) -> Sequence[float]:
    by_channel: dict[tuple[int, int], float] = {}
    for joint, torque in zip(state.body.chain.joints, state.actuation, strict=True):
        by_channel.setdefault((joint.actuator, joint.channel), torque)
    return [by_channel[channel] / units.torque for channel in _channels(state.body)]


def _curvatures(state: State, units: Units) -> Sequence[float]:
    return [
        angle / (joint.span / units.length)
        for joint, angle in zip(state.body.chain.joints, state.angles, strict=True)
    ]


def _link_positions(state: State, units: Units) -> Sequence[float]:
    length = units.length
    return [coordinate / length for position, _ in state.frames for coordinate in position]


def _link_orientations(state: State, units: Units) -> Sequence[float]:
    return [
        component
        for _, rotation in state.frames
        for component in geometry.quaternion_from_rotation(rotation)
    ]


def _base_pose(state: State, units: Units) -> Sequence[float]:
    pose, length = state.base_pose, units.length
    turn = geometry.quaternion_from_rotation(pose.rotation)
    return [*(coordinate / length for coordinate in pose.position), *turn]


def _tip_position(state: State, units: Units) -> Sequence[float]:
    chain = state.body.chain
    ends = [(limb.last_link, limb.tip) for limb in chain.limbs] or [(-1, chain.tip)]
    places = (Pose(*state.frames[link]).point(position) for link, position in ends)
    return [coordinate / units.length for place in places for coordinate in place]


def _energy(state: State, units: Units) -> Sequence[float]:
    pose = state.dynamics().at(state.angles, state.base_pose)
    velocity, spin = state.base_velocity
    return [
        pose.kinetic_energy([*spin, *velocity, *state.rates]) / units.torque,
        pose.elastic_energy() / units.torque,
        pose.gravity_energy(state.gravity) / units.torque,
    ]


def _contact_force(state: State, units: Units) -> Sequence[float]:
    return contact_columns.total(state.touches, state.number, units)


def _contact_pairs(state: State, units: Units) -> Sequence[float]:
    return contact_columns.pairs(state.touches, state.number, state.others, units)


def _link_contact_forces(state: State, units: Units) -> Sequence[float]:
    count = len(state.body.chain.links)
    return contact_columns.links(state.touches, state.number, count, units)


READINGS: dict[Quantity, Reader] = {
    "joint_angles": _angles,
    "joint_rates": _rates,
    "spring_torques": _spring_torques,
    "actuation": _actuation,
    "curvatures": _curvatures,
    "link_positions": _link_positions,
    "link_orientations": _link_orientations,
    "base_pose": _base_pose,
    "tip_position": _tip_position,
    "energy": _energy,
    "contact_force": _contact_force,
    "contact_pairs": _contact_pairs,
    "link_contact_forces": _link_contact_forces,
}
