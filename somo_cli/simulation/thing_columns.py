"""The names of the columns of the CSV for objects."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.simulation import contact_columns
from somo_cli.simulation.plan import Plan
from somo_cli.simulation.things import Reading

_NAMES: dict[Reading, tuple[str, ...]] = {
    "pose": tuple(f"pose.{part}" for part in ("x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")),
    "velocity": (
        *(f"velocity.{axis}_m_per_s" for axis in "xyz"),
        *(f"spin.{axis}_rad_per_s" for axis in "xyz"),
    ),
    "angles": tuple(f"angles.{axis}_rad" for axis in "xyz"),
    "contact_force": tuple(f"contact.{part}" for part in contact_columns.TOTAL),
}


def names(plan: Plan, index: int, reading: Reading) -> Sequence[str]:
    """Return the columns of a reading of an object of the plan, without the object's name."""
    if reading == "contact_pairs":
        return contact_columns.pair_names(plan, len(plan.bodies) + index)
    return _NAMES[reading]
