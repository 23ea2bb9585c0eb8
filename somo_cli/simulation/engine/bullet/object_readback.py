"""Compare an object that forces move, as the engine has loaded it, with the plan."""

from __future__ import annotations

import math
from collections.abc import Sequence

from somo_cli.manipulator import geometry
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.plan.model import PlannedObject

TOLERANCE = 1e-9  # relative; the engine keeps doubles, and diagonalises inertias itself


def object_mismatches(engine: BulletClient, index: int, planned: PlannedObject) -> list[str]:
    """Return one sentence for each number in which the engine's body differs from the plan.

    Mass, all principal moments, and where the centre of mass and the principal axes are.
    """
    told = engine.getDynamicsInfo(index, -1)
    (link,) = planned.rigid_object.chain.links
    found: list[str] = []

    def compare(what: str, engine: Sequence[float], ours: Sequence[float], size: float) -> None:
        if any(
            not math.isclose(a, b, rel_tol=TOLERANCE, abs_tol=TOLERANCE * size)
            for a, b in zip(engine, ours, strict=True)
        ):
            found.append(
                f"its {what} is {_shown(engine)} in the engine, {_shown(ours)} in the file"
            )

    compare("mass", [told[0]], [link.inertial.mass], 0.0)
    compare("centre of mass", told[3], geometry.ZERO, planned.rigid_object.chain.length)
    if planned.compound is None:
        wanted = link.inertial.inertia
    else:  # the axes of the engine's body are the principal ones
        x, y, z = planned.compound.moments
        wanted = (x, 0.0, 0.0, y, 0.0, z)
    x, y, z = told[2]
    axes = geometry.rotation_from_quaternion(told[4])
    own = geometry.rotated_tensor((x, 0.0, 0.0, y, 0.0, z), axes)
    # products of inertia of what is turned are rounded by the moments
    compare("inertia", own, wanted, 100 * max(wanted))
    return found


def _shown(values: Sequence[float]) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
