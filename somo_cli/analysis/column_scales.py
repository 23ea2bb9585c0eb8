"""The scale of each column: what an error of it is held against."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.analysis.column_families import QUATERNION_UNIT, ColumnFamily
from somo_cli.arrays import Array
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of

LEAST_SHARE = 0.01  # of the largest range in the same unit, below which a range is no scale
LEAST_ANGLE = 1e-3  # rad
LEAST_LENGTH = 1e-4  # of the longest manipulator


def scales(plan: Plan, families: Sequence[ColumnFamily], ranges: Array) -> list[float]:
    """Return the scale of each family, in its unit; `ranges` are those of the columns.

    It is the largest range among the columns of the family. What hardly moves is held against a
    hundredth of the largest range in the same unit, and at least against a milliradian or a
    ten-thousandth of the longest manipulator: the error of a joint that stays straight is one of
    the whole motion. A quaternion changes by half the angle, and is compared as such with angles.
    """
    chains = (body.chain.length for body in plan.bodies)
    length = max(chains, default=0.0) / unit_factors_of(plan).length
    least = {"rad": LEAST_ANGLE, "m": LEAST_LENGTH * length}
    own = [float(max(ranges[column - 1] for column in one.columns)) for one in families]
    largest: dict[str, float] = {}
    for family, size in zip(families, own, strict=True):
        dimension, factor = _dimension(family)
        largest[dimension] = max(largest.get(dimension, 0.0), factor * size)
    found = []
    for family, size in zip(families, own, strict=True):
        dimension, factor = _dimension(family)
        floor = max(LEAST_SHARE * largest[dimension], least.get(dimension, 0.0))
        found.append(max(size, floor / factor))
    return found


def _dimension(family: ColumnFamily) -> tuple[str, float]:
    """Return the unit in which a family is compared with others, and the factor to it."""
    return ("rad", 2.0) if family.unit == QUATERNION_UNIT else (family.unit, 1.0)
