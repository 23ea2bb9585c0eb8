"""Compare what the engine has loaded with what was compiled."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.geometry import Vector

TOLERANCE = 1e-9  # relative; the engine keeps doubles, and diagonalises inertias itself


@dataclass(frozen=True, slots=True)
class EngineLink:
    """Mass, centre of mass in the link's frame, and principal moments, as the engine has them."""

    mass: float
    centre: Vector
    moments: Vector


@dataclass(frozen=True, slots=True)
class EngineJoint:
    """Parent's index (-1 for the root), axis and limits of a joint, as the engine has them."""

    parent: int
    axis: Vector
    lower: float
    upper: float


def mismatches(
    chain: Chain, links: Sequence[EngineLink | None], joints: Sequence[EngineJoint]
) -> list[str]:
    """Return one sentence for each number in which the engine's body differs from the chain.

    `links` holds None where the engine keeps no mass, which is a base that cannot move.
    """
    differences: list[str] = []

    def compare(what: str, engine: Sequence[float], ours: Sequence[float], size: float) -> None:
        if any(
            not math.isclose(a, b, rel_tol=TOLERANCE, abs_tol=TOLERANCE * size)
            for a, b in zip(engine, ours, strict=True)
        ):
            differences.append(
                f"{what} is {_formatted(engine)} in the engine, {_formatted(ours)} in the file"
            )

    for link, engine_link in zip(chain.links, links, strict=True):
        if engine_link is None:
            continue
        own = geometry.principal_moments(link.inertial.inertia)
        compare(f"mass of {link.name}", [engine_link.mass], [link.inertial.mass], 0.0)
        compare(
            f"centre of mass of {link.name}",
            engine_link.centre,
            link.inertial.centre,
            chain.length,
        )
        compare(f"inertia of {link.name}", sorted(engine_link.moments), own, 100 * own[2])
    for joint, engine_joint in zip(chain.joints, joints, strict=True):
        if engine_joint.parent != joint.parent - 1:
            differences.append(
                f"parent of {joint.name} is link {engine_joint.parent} in the engine"
            )
        compare(f"axis of {joint.name}", engine_joint.axis, joint.axis, 1.0)
        limits = (joint.lower, joint.upper)
        compare(f"limits of {joint.name}", (engine_joint.lower, engine_joint.upper), limits, 1.0)
    return differences


def _formatted(values: Sequence[float]) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
