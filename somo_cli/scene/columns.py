"""The columns of the CSV: their names, and which quantity of what each of them is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from somo_cli.manipulator.chain import Chain
from somo_cli.scene.column_selection import ColumnSelection, select_columns
from somo_cli.scene.contact_surface import GROUND_NAME
from somo_cli.scene.model import Quantity, limbs_by_tip_name
from somo_cli.scene.rigid_object import ObjectQuantity

_XYZ = ("x_m", "y_m", "z_m")
_XYZW = ("qx", "qy", "qz", "qw")
_ENERGIES = ("kinetic_j", "elastic_j", "gravity_j")
_TOTAL_FORCE = ("fx_n", "fy_n", "fz_n", "normal_n")
_FORCE_AND_FRICTION = (
    *_TOTAL_FORCE,
    *("friction_n", "friction_x_n", "friction_y_n", "friction_z_n"),
)
_OBJECT_NAMES: dict[ObjectQuantity, tuple[str, ...]] = {
    "pose": tuple(f"pose.{part}" for part in _XYZ + _XYZW),
    "velocity": (
        *(f"velocity.{axis}_m_per_s" for axis in "xyz"),
        *(f"spin.{axis}_rad_per_s" for axis in "xyz"),
    ),
    "angles": tuple(f"angles.{axis}_rad" for axis in "xyz"),
    "contact_force": tuple(f"contact.{part}" for part in _TOTAL_FORCE),
}
_QUATERNION_START = {"base_pose": 3, "pose": 3, "link_orientations": 0}
"""At which column of a kind unit quaternions begin, four columns each."""

NEEDS_BASE_POSE = frozenset(
    {"link_positions", "link_orientations", "base_pose", "tip_position", "energy"}
)
"""The quantities that ask where the base is."""

NEEDS_VELOCITIES = frozenset({"joint_rates", "energy"})
"""The quantities that ask for the velocities of the instant; of objects, `velocity` does."""

NEEDS_CONTACTS = frozenset({"contact_force", "contact_pairs", "link_contact_forces"})
"""The quantities and readings that ask for contact points."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """What a run records, and of what: all that the columns depend on.

    Manipulators are named and have their chain, in any unit; objects are named. Only columns that
    match one of the `patterns` are recorded, if there are any.
    """

    manipulators: tuple[tuple[str, Chain], ...]
    objects: tuple[str, ...]
    has_ground: bool
    quantities: tuple[Quantity, ...]
    object_quantities: tuple[ObjectQuantity, ...]
    patterns: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of manipulators, objects and the ground, as contacts number them."""
        return (*(name for name, _ in self.manipulators), *self.objects, GROUND_NAME)

    def contact_partners(self, number: int) -> tuple[int, ...]:
        """Return the numbers of what may touch a manipulator or object, in the columns' order."""
        count = len(self.manipulators) + len(self.objects) + self.has_ground
        return tuple(other for other in range(count) if other != number)


@dataclass(frozen=True, slots=True)
class BodyColumnGroup:
    """The columns [first, last) of one quantity of one body, all of one unit."""

    body: int
    quantity: Quantity
    first: int
    last: int
    selection: ColumnSelection


@dataclass(frozen=True, slots=True)
class ObjectColumnGroup:
    """The columns [first, last) of one reading of one object."""

    object_index: int
    reading: ObjectQuantity
    first: int
    last: int
    selection: ColumnSelection


def header(recorded: Recorded) -> list[str]:
    """Return the name of every column, time first; each name ends with its unit."""
    chosen = [group.selection for group in body_column_groups(recorded)] + [
        one.selection for one in object_column_groups(recorded)
    ]
    return ["time_s", *(name for one in chosen for name in one.names)]


def body_column_groups(recorded: Recorded) -> list[BodyColumnGroup]:
    """Return what the columns of manipulators are, in the order of the header."""
    found: list[BodyColumnGroup] = []
    first = 1
    for number, (owner, chain) in enumerate(recorded.manipulators):
        for quantity in recorded.quantities:
            if quantity == "contact_pairs":
                own = _pair_names(recorded, number)
            else:
                own = _names(chain, quantity)
            chosen = select_columns(recorded.patterns, [f"{owner}.{name}" for name in own])
            if chosen.indices:
                last = first + len(chosen.indices)
                found.append(BodyColumnGroup(number, quantity, first, last, chosen))
                first = last
    return found


def object_column_groups(recorded: Recorded) -> list[ObjectColumnGroup]:
    """Return what the columns of objects are, behind those of manipulators."""
    found: list[ObjectColumnGroup] = []
    first = max((group.last for group in body_column_groups(recorded)), default=1)
    for number, owner in enumerate(recorded.objects):
        for reading in recorded.object_quantities:
            if reading == "contact_pairs":
                own = _pair_names(recorded, len(recorded.manipulators) + number)
            else:
                own = list(_OBJECT_NAMES[reading])
            chosen = select_columns(recorded.patterns, [f"{owner}.{name}" for name in own])
            if chosen.indices:
                last = first + len(chosen.indices)
                found.append(ObjectColumnGroup(number, reading, first, last, chosen))
                first = last
    return found


def quaternion_columns(recorded: Recorded) -> Iterator[tuple[int, ...]]:
    """Yield the columns of every unit quaternion, or what is recorded of it; time is column 0."""
    kinds: list[tuple[str, int, ColumnSelection]] = [
        *((one.quantity, one.first, one.selection) for one in body_column_groups(recorded)),
        *((one.reading, one.first, one.selection) for one in object_column_groups(recorded)),
    ]
    for kind, first, chosen in kinds:
        if kind not in _QUATERNION_START:
            continue
        columns_by_quaternion: dict[int, list[int]] = {}
        for column, index in enumerate(chosen.indices, start=first):
            if index >= _QUATERNION_START[kind]:
                columns_by_quaternion.setdefault((index - _QUATERNION_START[kind]) // 4, []).append(
                    column
                )
        yield from map(tuple, columns_by_quaternion.values())


def base_pose_names(owner: str) -> list[str]:
    """Return the columns of the pose of a manipulator's base: position, quaternion."""
    return [f"{owner}.base_pose.{part}" for part in _XYZ + _XYZW]


def _pair_names(recorded: Recorded, number: int) -> list[str]:
    """Return the columns of the force of each partner on a manipulator or object."""
    names = recorded.names
    return [
        f"contact.{names[other]}.{part}"
        for other in recorded.contact_partners(number)
        for part in _FORCE_AND_FRICTION
    ]


def _names(chain: Chain, quantity: Quantity) -> list[str]:
    joints = [joint.name for joint in chain.joints]
    links = [link.name for link in chain.links]
    if quantity == "actuation":
        return [f"{name}.torque_nm" for name in _channel_names(chain)]
    suffixes: dict[Quantity, tuple[list[str], tuple[str, ...]]] = {
        "joint_angles": (joints, ("angle_rad",)),
        "joint_rates": (joints, ("rate_rad_per_s",)),
        "spring_torques": (joints, ("spring_torque_nm",)),
        "curvatures": (joints, ("curvature_per_m",)),
        "link_positions": (links, _XYZ),
        "link_orientations": (links, _XYZW),
        "base_pose": (["base_pose"], _XYZ + _XYZW),
        "tip_position": (list(limbs_by_tip_name(chain)), _XYZ),
        "energy": (["energy"], _ENERGIES),
        "contact_force": (["contact"], _TOTAL_FORCE),
        "link_contact_forces": ([f"{link}.contact" for link in links], _FORCE_AND_FRICTION),
    }
    owners, units = suffixes[quantity]
    return [f"{owner}.{unit}" for owner in owners for unit in units]


def channels(chain: Chain) -> list[tuple[int, int]]:
    """Return actuator and channel of every column of actuation, in their order."""
    return sorted({(joint.actuator, joint.channel) for joint in chain.joints})


def _channel_names(chain: Chain) -> list[str]:
    names: dict[tuple[int, int], str] = {}
    for joint in chain.joints:
        limb = chain.backbone_of(joint)
        number = joint.actuator - limb.first_actuator
        name = f"{limb.prefix}actuator_{number}_axis_{joint.channel}"
        names[joint.actuator, joint.channel] = name
    return [names[channel] for channel in channels(chain)]
