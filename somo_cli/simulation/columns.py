"""The columns of the CSV: their names, and their values in SI from the state of a body."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.dimensions import Dimension
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose, link_poses
from somo_cli.simulation.dynamics import ChainDynamics
from somo_cli.simulation.plan import TORQUE, Body, Plan
from somo_cli.simulation.scene import Quantity, tips
from somo_cli.simulation.things import Reading
from somo_cli.simulation.world import WorldThing

_XYZ = ("x_m", "y_m", "z_m")
_XYZW = ("qx", "qy", "qz", "qw")
_FORCES = ("fx_n", "fy_n", "fz_n", "normal_n")
_ENERGIES = ("kinetic_j", "elastic_j", "gravity_j")
_OF_THINGS: dict[Reading, list[str]] = {
    "pose": [f"pose.{part}" for part in _XYZ + _XYZW],
    "contact_force": [f"contact.{part}" for part in _FORCES],
}


@dataclass
class State:
    """One body at one instant, in engine units: angles, rates and actuation by joint.

    `base_velocity` holds the velocity of the base's centre of mass and its spin, in the world;
    `contact` the force of all that touches the body in the step before, and the sum of normal ones.
    """

    body: Body
    angles: Sequence[float]
    rates: Sequence[float]
    actuation: Sequence[float]
    base: Callable[[], Pose]
    base_velocity: tuple[Vector, Vector]
    gravity: Vector
    dynamics: Callable[[], ChainDynamics]
    contact: Sequence[float] = ()

    @cached_property
    def base_pose(self) -> Pose:
        """Pose of the base's URDF frame in the world; read only if a column needs it."""
        return self.base()

    @cached_property
    def poses(self) -> tuple[Pose, ...]:
        """Pose of every link frame in the world, root first."""
        return link_poses(self.body.chain, self.angles, self.base_pose)


@dataclass(frozen=True, slots=True)
class Units:
    """Engine units per SI unit."""

    length: float
    torque: float
    force: float


Reader: TypeAlias = Callable[[State, Units], Iterator[float]]


def units_of(plan: Plan) -> Units:
    """Return the factors that lead from SI to the units of a plan."""
    force = plan.scale.factor(Dimension(mass=1, length=1, time=-2))
    return Units(plan.scale.factor(Dimension(length=1)), plan.scale.factor(TORQUE), force)


def header(plan: Plan) -> list[str]:
    """Return the name of every column, time first; each name ends with its unit."""
    names = ["time_s"]
    for body in plan.bodies:
        for quantity in plan.columns:
            names.extend(f"{body.name}.{name}" for name in _names(body, quantity))
    for planned in plan.things:
        for reading in plan.of_things:
            names.extend(f"{planned.thing.name}.{name}" for name in _OF_THINGS[reading])
    return names


@dataclass(frozen=True, slots=True)
class Group:
    """The columns [first, last) of one quantity of one body, all of one unit."""

    body: int
    quantity: Quantity
    first: int
    last: int


def groups(plan: Plan) -> list[Group]:
    """Return what the columns of the header are, in their order, time left out.

    Objects are counted after the bodies, and a pose of theirs is that of a base.
    """
    found: list[Group] = []
    first = 1
    for number, body in enumerate(plan.bodies):
        for quantity in plan.columns:
            last = first + len(_names(body, quantity))
            found.append(Group(number, quantity, first, last))
            first = last
    for number, _ in enumerate(plan.things, start=len(plan.bodies)):
        for reading in plan.of_things:
            last = first + len(_OF_THINGS[reading])
            kind: Quantity = "base_pose" if reading == "pose" else "contact_force"
            found.append(Group(number, kind, first, last))
            first = last
    return found


def row(plan: Plan, units: Units, time: float, states: Sequence[State]) -> list[float]:
    """Return one row of values in SI, in the order of the header."""
    values = [float(f"{time:.12g}")]  # 0.018, not 0.018000000000000002
    for state in states:
        for quantity in plan.columns:
            values.extend(_READINGS[quantity](state, units))
    return values


def of_things(plan: Plan, units: Units, things: Sequence[WorldThing], step: int) -> list[float]:
    """Return the values of the objects' columns after a step, in SI, in the header's order."""
    values: list[float] = []
    for thing in things:
        for reading in plan.of_things:
            if reading == "contact_force":
                force = thing.contact_force() if step > 0 else (0.0, 0.0, 0.0, 0.0)
                values.extend(value / units.force for value in force)
            else:
                pose = thing.pose()
                values.extend(coordinate / units.length for coordinate in pose.position)
                values.extend(geometry.quaternion_from_rotation(pose.rotation))
    return values


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
        "contact_force": (["contact"], _FORCES),
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


def _angles(state: State, units: Units) -> Iterator[float]:
    yield from state.angles


def _rates(state: State, units: Units) -> Iterator[float]:
    yield from state.rates


def _spring_torques(state: State, units: Units) -> Iterator[float]:
    for joint, angle in zip(state.body.chain.joints, state.angles, strict=True):
        yield -joint.stiffness * (angle - joint.neutral_position) / units.torque


def _actuation(state: State, units: Units) -> Iterator[float]:
    by_channel: dict[tuple[int, int], float] = {}
    for joint, torque in zip(state.body.chain.joints, state.actuation, strict=True):
        by_channel.setdefault((joint.actuator, joint.channel), torque)
    for channel in _channels(state.body):
        yield by_channel[channel] / units.torque


def _curvatures(state: State, units: Units) -> Iterator[float]:
    for joint, angle in zip(state.body.chain.joints, state.angles, strict=True):
        yield angle / (joint.span / units.length)


def _link_positions(state: State, units: Units) -> Iterator[float]:
    for pose in state.poses:
        yield from (coordinate / units.length for coordinate in pose.position)


def _link_orientations(state: State, units: Units) -> Iterator[float]:
    for pose in state.poses:
        yield from geometry.quaternion_from_rotation(pose.rotation)


def _base_pose(state: State, units: Units) -> Iterator[float]:
    yield from (coordinate / units.length for coordinate in state.base_pose.position)
    yield from geometry.quaternion_from_rotation(state.base_pose.rotation)


def _tip_position(state: State, units: Units) -> Iterator[float]:
    chain = state.body.chain
    ends = [(limb.last_link, limb.tip) for limb in chain.limbs] or [(-1, chain.tip)]
    for link, position in ends:
        tip = state.poses[link].point(position)
        yield from (coordinate / units.length for coordinate in tip)


def _energy(state: State, units: Units) -> Iterator[float]:
    pose = state.dynamics().at(state.angles, state.base_pose)
    velocity, spin = state.base_velocity
    yield pose.kinetic_energy([*spin, *velocity, *state.rates]) / units.torque
    yield pose.elastic_energy() / units.torque
    yield pose.gravity_energy(state.gravity) / units.torque


def _contact_force(state: State, units: Units) -> Iterator[float]:
    yield from (value / units.force for value in state.contact)


_READINGS: dict[Quantity, Reader] = {
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
}
