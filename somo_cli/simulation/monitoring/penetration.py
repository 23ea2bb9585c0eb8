"""The penetration monitor: warns of bodies deep inside each other, which rigid bodies never are.

The engine stops bodies that touch, and pushes out a fifth of the depth in each step. Where a step
carries a body far into another, the impact comes late, in a wrong direction, or not at all; the
run may stay finite and look right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.manipulator.chain import Link
from somo_cli.manipulator.dimensions import Dimension
from somo_cli.simulation.engine.contacts import LinkIndex
from somo_cli.simulation.engine.interface import World
from somo_cli.simulation.monitoring.findings import Finding, half_step_hint
from somo_cli.simulation.plan.model import Plan

DEEP_PENETRATION_RATIO = 0.2  # of the thickness of the thinner of two bodies
MAX_TIME_BETWEEN_SAMPLES = 8e-3  # s, unless a step is longer: half is pushed out in three steps


@dataclass(frozen=True, slots=True)
class Penetration:
    """How deep [m] two bodies were in each other, and when [s].

    `depth_ratio` is over the thickness of the thinner of the two.
    """

    time: float
    depth: float
    depth_ratio: float
    bodies: tuple[str, str]

    @property
    def is_deep(self) -> bool:
        """Whether the contact was not followed."""
        return self.depth_ratio > DEEP_PENETRATION_RATIO


class PenetrationMonitor:
    """Keeps the deepest penetration of a run, relative to the thickness of the thinner body."""

    def __init__(self, plan: Plan, world: World) -> None:
        self.deepest: Penetration | None = None
        self.last: Sequence[tuple[LinkIndex, LinkIndex, float]] = ()
        """Which parts were how deep in each other at the last sample [engine units]."""
        self._world = world
        self._time_step = plan.time_step
        self._metre = plan.scale.factor(Dimension(length=1))
        links = [body.chain.links for body in plan.bodies]
        links += [planned.rigid_object.chain.links for planned in plan.objects]
        self._thickness = [[thickness_of(link) for link in chain] for chain in links]
        self._names = plan.recorded.names

    def update(self, step: int) -> None:
        """Sample the depths of the last step."""
        self.last = self._world.penetrations()
        for first, second, depth in self.last:
            depth_ratio = depth / min(self._thickness_at(first), self._thickness_at(second))
            if self.deepest is None or depth_ratio > self.deepest.depth_ratio:
                names = self._names[first[0]], self._names[second[0]]
                self.deepest = Penetration(
                    step * self._time_step, depth / self._metre, depth_ratio, names
                )

    def finding(self) -> Finding | None:
        """Return the deepest penetration as a finding, None if contact was followed."""
        found = self.deepest
        if found is None or not found.is_deep:
            return None
        first, second = found.bodies
        return Finding(
            "deep-penetration",
            found.time,
            found.bodies,
            f"at {found.time:.4g} s '{first}' and '{second}' were {1e3 * found.depth:.3g} mm deep "
            f"in each other, {100 * found.depth_ratio:.0f} % of the thinner one's thickness: "
            "contact was not followed",
            f"{half_step_hint(self._time_step)}, and see that they do not overlap at the start",
            (("depth_m", found.depth), ("depth_ratio", found.depth_ratio)),
        )

    def _thickness_at(self, part: tuple[int, int]) -> float:
        body, link = part
        return self._thickness[body][link] if body < len(self._thickness) else float("inf")


def steps_between_samples(time_step: float, max_steps: int) -> int:
    """Return the number of steps from one sample to the next, at most `max_steps`."""
    return max(1, min(max_steps, int(MAX_TIME_BETWEEN_SAMPLES / time_step)))


def thickness_of(link: Link) -> float:
    """Return the least extent of the thickest shape of a link; infinite where it has none."""
    return max((shape.solid.smallest_extent for shape in link.shapes), default=float("inf"))
