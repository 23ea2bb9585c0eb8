"""The columns of the CSV for objects: names, and values in SI from the state of an object."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import ZERO, Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation import contact_columns
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.things import Reading
from somo_cli.simulation.touching import Touch
from somo_cli.simulation.units import Units

_NAMES: dict[Reading, tuple[str, ...]] = {
    "pose": tuple(f"pose.{part}" for part in ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")),
    "velocity": (
        *(f"velocity.{axis}_m_per_s" for axis in "xyz"),
        *(f"spin.{axis}_rad_per_s" for axis in "xyz"),
    ),
    "angles": tuple(f"angles.{axis}_rad" for axis in "xyz"),
    "contact_force": tuple(f"contact.{part}" for part in contact_columns.TOTAL),
}


@dataclass
class ThingState:
    """One object at one instant, in engine units and the world's axes; only what columns need.

    `number` is that of the object behind all bodies, and `touches` what touched anything in the
    step before. `turned` is how far it has turned since the start, as `turning` counts it [rad].
    """

    number: int
    others: Sequence[int]
    pose: Pose = field(default_factory=Pose)
    velocity: tuple[Vector, Vector] = (ZERO, ZERO)
    turned: Vector = ZERO
    touches: Sequence[Touch] = ()


ThingReader: TypeAlias = Callable[[ThingState, Units], Sequence[float]]


def names(plan: Plan, index: int, reading: Reading) -> Sequence[str]:
    """Return the columns of a reading of an object of the plan, without the object's name."""
    if reading == "contact_pairs":
        return contact_columns.pair_names(plan, len(plan.bodies) + index)
    return _NAMES[reading]


def _pose(state: ThingState, units: Units) -> Sequence[float]:
    pose, length = state.pose, units.length
    turn = geometry.quaternion_from_rotation(pose.rotation)
    return [*(coordinate / length for coordinate in pose.position), *turn]


def _velocity(state: ThingState, units: Units) -> Sequence[float]:
    linear, spin = state.velocity
    return [*(coordinate / units.length for coordinate in linear), *spin]


def _angles(state: ThingState, units: Units) -> Sequence[float]:
    return state.turned


def _contact_force(state: ThingState, units: Units) -> Sequence[float]:
    return contact_columns.total(state.touches, state.number, units)


def _contact_pairs(state: ThingState, units: Units) -> Sequence[float]:
    return contact_columns.pairs(state.touches, state.number, state.others, units)


READINGS: dict[Reading, ThingReader] = {
    "pose": _pose,
    "velocity": _velocity,
    "angles": _angles,
    "contact_force": _contact_force,
    "contact_pairs": _contact_pairs,
}
