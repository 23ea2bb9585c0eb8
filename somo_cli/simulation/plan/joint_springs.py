"""The spring-dampers of the joints of a chain, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.arrays import Array


@dataclass(frozen=True, slots=True)
class JointSprings:
    """Stiffness [N·m/rad], damping [N·m·s/rad] and neutral angle [rad] of every joint, shape (n,).

    In the units of the engine.
    """

    stiffness: Array
    damping: Array
    neutral: Array
