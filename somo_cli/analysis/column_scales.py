"""The scale of each column: what an error of it is held against."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.analysis.column_families import QUATERNION_UNIT, ColumnFamily
from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.plan.units import unit_factors_of

LEAST_SHARE = 0.01  # of the largest range in the same unit, below which a range is no scale
LEAST_ANGLE = 1e-3  # rad
LEAST_LENGTH = 1e-4  # of the longest manipulator or object
LEAST_FORCE = 1e-4  # of the weight of all that is simulated


def scales(plan: Plan, families: Sequence[ColumnFamily], ranges: Array) -> list[float]:
    """Return the scale of each family, in its unit; `ranges` are those of the columns.

    It is the largest range among the columns of the family. What hardly moves is held against a
    hundredth of the largest range in the same unit, and at least against what is negligible in the
    scene: the error of a joint that stays straight is one of the whole motion, and a block at rest
    has velocities of rounding alone. A quaternion changes by half the angle, and is compared as
    such with angles.
    """
    least = _negligible(plan)
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


def _negligible(plan: Plan) -> dict[str, float]:
    """Return what is negligible in each unit: a small angle and length, in a second, and a force.

    The length is a ten-thousandth of the longest manipulator or object, the force of the weight.
    """
    units = unit_factors_of(plan)
    lengths = [body.chain.length for body in plan.bodies]
    links = [link for body in plan.bodies for link in body.chain.links]
    for planned in plan.objects:
        link = planned.rigid_object.chain.links[0]
        lengths += [2 * shape.solid.circumradius for shape in link.shapes]
        links += [] if planned.rigid_object.has_prescribed_pose else [link]
    length = max(lengths, default=0.0) / units.length
    weight = geometry.norm(plan.gravity) * sum(link.inertial.mass for link in links) / units.force
    moment = LEAST_FORCE * weight * length
    return {
        "rad": LEAST_ANGLE,
        "rad/s": LEAST_ANGLE,
        "m": LEAST_LENGTH * length,
        "m/s": LEAST_LENGTH * length,
        "1/m": LEAST_ANGLE / length if length else 0.0,
        "N": LEAST_FORCE * weight,
        "N·m": moment,
        "J": moment,
    }


def _dimension(family: ColumnFamily) -> tuple[str, float]:
    """Return the unit in which a family is compared with others, and the factor to it."""
    return ("rad", 2.0) if family.unit == QUATERNION_UNIT else (family.unit, 1.0)
