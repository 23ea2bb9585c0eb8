"""Find the definitions of the actuators of a limb, those of one joint from their neighbours."""

from __future__ import annotations

from collections.abc import Sequence

from somo_cli.exchange.flat_model import FlatJoint, FlatLink
from somo_cli.exchange.found_actuator import FoundActuator, found_actuator
from somo_cli.exchange.found_parts import difference
from somo_cli.exchange.split_limb import SplitLimb
from somo_cli.manipulator.solids import Inertial


def found_actuators(
    split: SplitLimb,
    links: Sequence[FlatLink],
    joints: Sequence[FlatJoint],
    start: float,
    size: float,
) -> list[FoundActuator]:
    """Return the definition of each actuator of a limb, whose first begins at height `start`.

    An actuator of several joints has a link of its own. One of a single joint shares both, with
    what is below and above: its mass is what a known neighbour leaves of a link, or all of the last
    link without tips. Raises NotADefinitionError.
    """
    starts = [start]
    for one in split.actuators:
        starts.append(starts[-1] + sum(segment.solid.height for segment in one.segments))
    count = len(split.actuators)
    found: dict[int, FoundActuator] = {}

    def find(number: int, half: Inertial | None) -> None:
        one = split.actuators[number]
        found[number] = found_actuator(one, links, joints, starts[number], size, half)

    several = [number for number in range(count) if len(split.actuators[number].segments) > 2]
    for number in several:
        find(number, None)
    while len(found) < count:
        halves = {
            number: _half(number, split, links, found)
            for number in range(count)
            if number not in found
        }
        known = [number for number, half in halves.items() if half is not None]
        number = known[0] if known else min(halves)
        find(number, halves[number])
    return [found[number] for number in range(count)]


def _half(
    number: int, split: SplitLimb, links: Sequence[FlatLink], found: dict[int, FoundActuator]
) -> Inertial | None:
    """Return the mass properties of a segment of an actuator of one joint, if they are known."""
    one = split.actuators[number]
    if number - 1 in found:
        return difference(links[one.first - 1].inertial, found[number - 1].last)
    if number + 1 in found:
        return difference(links[one.last - 1].inertial, found[number + 1].first)
    if number + 1 == len(split.actuators) and not split.tips:
        return links[-1].inertial
    return None
