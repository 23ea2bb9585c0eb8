"""The columns of the CSV: their names, and which quantity of what each of them is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from somo_cli.simulation import thing_columns
from somo_cli.simulation.contact_columns import LOAD, TOTAL, pair_names
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.scene import Quantity, tips
from somo_cli.simulation.selection import Kept, kept
from somo_cli.simulation.things import Reading

_XYZ = ("x_m", "y_m", "z_m")
_XYZW = ("qx", "qy", "qz", "qw")
_ENERGIES = ("kinetic_j", "elastic_j", "gravity_j")
_TURN_AT = {"base_pose": 3, "pose": 3, "link_orientations": 0}
"""At which column of a kind unit quaternions begin, four columns each."""

OF_BASE = frozenset({"link_positions", "link_orientations", "base_pose", "tip_position", "energy"})
"""The quantities that ask where the base is."""

OF_RATES = frozenset({"joint_rates", "energy"})
"""The quantities that ask for the velocities of the instant; of objects, `velocity` does."""

OF_CONTACT = frozenset({"contact_force", "contact_pairs", "link_contact_forces"})
"""The quantities and readings that ask for contact points."""


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


def channels(body: Body) -> list[tuple[int, int]]:
    """Return actuator and channel of every column of actuation, in their order."""
    return sorted({(joint.actuator, joint.channel) for joint in body.chain.joints})


def _names_of_channels(body: Body) -> list[str]:
    names: dict[tuple[int, int], str] = {}
    for joint in body.chain.joints:
        limb = body.chain.backbone_of(joint)
        number = joint.actuator - limb.first_actuator
        name = f"{limb.prefix}actuator_{number}_axis_{joint.channel}"
        names[joint.actuator, joint.channel] = name
    return [names[channel] for channel in channels(body)]
