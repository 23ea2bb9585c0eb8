"""The quantities that can be recorded of manipulators and objects, one row for each.

A new quantity is a row here, a name in the schema, and a function of its values in
`simulation/recording`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from somo_cli.manipulator.chain import Chain
from somo_cli.scene.model import Quantity
from somo_cli.scene.reader import limbs_by_tip_name
from somo_cli.scene.rigid_object import ObjectQuantity

Need: TypeAlias = Literal["base_pose", "base_velocity", "velocities", "contacts"]
"""State that only some columns need: pose and velocity of the base, velocities at the row's time,
contacts.
"""

Owners: TypeAlias = Callable[[Chain], Sequence[str]]
"""Returns the names of the parts of a chain that have their own columns, such as its joints."""

_XYZ = ("x_m", "y_m", "z_m")
_XYZW = ("qx", "qy", "qz", "qw")
_TOTAL_FORCE = ("fx_n", "fy_n", "fz_n", "normal_n")
FORCE_AND_FRICTION = (
    *_TOTAL_FORCE,
    *("friction_n", "friction_x_n", "friction_y_n", "friction_z_n"),
)
"""The columns of one contact force [N]: in the world frame, its normal part, its friction."""


@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of one quantity.

    Each owner has a column for each of the `parts`, whose names end with their unit; a quantity
    without owners has one column for each part. `unit` is that of the error of the quantity. The
    error of `vector` columns together is the length of their difference. From column
    `quaternion_start` on the columns are unit quaternions of four columns each.
    """

    parts: tuple[str, ...]
    unit: str
    owners: Owners | None = None
    needs: frozenset[Need] = field(default_factory=frozenset)
    vector: int = 1
    quaternion_start: int | None = None

    def names(self, chain: Chain) -> list[str]:
        """Return the names of the columns, without the prefix of the manipulator."""
        if self.owners is None:
            return list(self.parts)
        return [f"{owner}.{part}" for owner in self.owners(chain) for part in self.parts]


def channels(chain: Chain) -> list[tuple[int, int]]:
    """Return (actuator, axis) for each column of actuation, in the order of the columns."""
    return sorted({(joint.actuator, joint.channel) for joint in chain.joints})


def joint_names(chain: Chain) -> list[str]:
    """Return the names of the joints."""
    return [joint.name for joint in chain.joints]


def link_names(chain: Chain) -> list[str]:
    """Return the names of the links."""
    return [link.name for link in chain.links]


def tip_names(chain: Chain) -> list[str]:
    """Return the names of the tips."""
    return list(limbs_by_tip_name(chain))


def tip_velocity_names(chain: Chain) -> list[str]:
    """Return a name for the velocity of each tip."""
    return [f"{tip}_velocity" for tip in limbs_by_tip_name(chain)]


def tip_orientation_names(chain: Chain) -> list[str]:
    """Return a name for the orientation of each tip."""
    return [f"{tip}_orientation" for tip in limbs_by_tip_name(chain)]


def channel_names(chain: Chain) -> list[str]:
    """Return the name of each axis of an actuator, in the order of `channels`."""
    names: dict[tuple[int, int], str] = {}
    for joint in chain.joints:
        limb = chain.backbone_of(joint)
        number = joint.actuator - limb.first_actuator
        name = f"{limb.prefix}actuator_{number}_axis_{joint.channel}"
        names[joint.actuator, joint.channel] = name
    return [names[channel] for channel in channels(chain)]


def _prefixed(prefix: str, parts: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{prefix}.{part}" for part in parts)


_BASE: frozenset[Need] = frozenset({"base_pose"})
_VELOCITIES: frozenset[Need] = frozenset({"velocities"})
_BASE_VELOCITY: frozenset[Need] = frozenset({"base_velocity"})
_CONTACTS: frozenset[Need] = frozenset({"contacts"})

BODY_COLUMNS: dict[Quantity, Columns] = {
    "joint_angles": Columns(("angle_rad",), "rad", joint_names),
    "joint_rates": Columns(("rate_rad_per_s",), "rad/s", joint_names, _VELOCITIES),
    "spring_torques": Columns(("spring_torque_nm",), "N·m", joint_names),
    "actuation": Columns(("torque_nm",), "N·m", channel_names),
    "link_positions": Columns(_XYZ, "m", link_names, _BASE, vector=3),
    "link_orientations": Columns(_XYZW, "1", link_names, _BASE, vector=4, quaternion_start=0),
    "base_pose": Columns(
        _prefixed("base_pose", _XYZ + _XYZW), "m", None, _BASE, vector=3, quaternion_start=3
    ),
    "tip_position": Columns(_XYZ, "m", tip_names, _BASE, vector=3),
    "tip_velocity": Columns(
        tuple(f"{axis}_m_per_s" for axis in "xyz"),
        "m/s",
        tip_velocity_names,
        _BASE | _VELOCITIES | _BASE_VELOCITY,
        vector=3,
    ),
    "tip_orientation": Columns(
        _XYZW, "1", tip_orientation_names, _BASE, vector=4, quaternion_start=0
    ),
    "bending_angles": Columns(("bend_rad",), "rad", channel_names),
    "curvatures": Columns(("curvature_per_m",), "1/m", joint_names),
    "energy": Columns(
        _prefixed("energy", ("kinetic_j", "elastic_j", "gravity_j")),
        "J",
        needs=_BASE | _VELOCITIES | _BASE_VELOCITY,
    ),
    "contact_force": Columns(_prefixed("contact", _TOTAL_FORCE), "N", needs=_CONTACTS),
    "contact_pairs": Columns((), "N", needs=_CONTACTS),
    "link_contact_forces": Columns(
        _prefixed("contact", FORCE_AND_FRICTION), "N", link_names, _CONTACTS
    ),
}
"""The quantities of a manipulator; the columns of contact pairs depend on the whole scene."""

OBJECT_COLUMNS: dict[ObjectQuantity, Columns] = {
    "pose": Columns(_prefixed("pose", _XYZ + _XYZW), "m", vector=3, quaternion_start=3),
    "velocity": Columns(
        (
            *(f"velocity.{axis}_m_per_s" for axis in "xyz"),
            *(f"spin.{axis}_rad_per_s" for axis in "xyz"),
        ),
        "m/s",
        needs=_VELOCITIES,
    ),
    "angles": Columns(tuple(f"angles.{axis}_rad" for axis in "xyz"), "rad"),
    "contact_force": Columns(_prefixed("contact", _TOTAL_FORCE), "N", needs=_CONTACTS),
    "contact_pairs": Columns((), "N", needs=_CONTACTS),
}
"""The quantities of an object."""
