"""Split a serial chain of a foreign model into what a definition has: base, actuators and tips.

In a definition, an actuator of n segments has n joints between n + 1 links of one shape, of which
the first and the last share a rigid body with what is below and above. So the body of link i has
the segment after joint i, and where an actuator ends the first segment of the next. Rounded shapes
have a filler at each hinge, which belongs to the body below it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.exchange.flat_model import FlatJoint, FlatLink
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.solids import Box, Cylinder, Sphere

NEAR = 1e-9
"""Differences of lengths, relative to the size of the model, that are rounding."""


class NotADefinitionError(ValueError):
    """A model that no definition describes; the message says why."""


@dataclass(frozen=True, slots=True)
class SplitActuator:
    """The joints [first, last) of an actuator, and its n + 1 segments."""

    first: int
    last: int
    segments: tuple[Shape, ...]
    is_rounded: bool

    @property
    def links(self) -> tuple[int, ...]:
        """The number of the link of each segment; 0 is the root."""
        return tuple(range(self.first, self.last + 1))


@dataclass(frozen=True, slots=True)
class SplitLimb:
    """Shapes of the base, actuators, shapes of the tips, in the frame of the limb."""

    base: tuple[Shape, ...]
    actuators: tuple[SplitActuator, ...]
    tips: tuple[Shape, ...]


def split_limb(
    root: Sequence[Shape], links: Sequence[FlatLink], joints: Sequence[FlatJoint], size: float
) -> SplitLimb:
    """Return the parts of a limb with joints in series; `root` has its shapes on the root.

    `size` is that of the model. Raises NotADefinitionError.
    """
    count = len(joints)
    below: list[Shape] = []  # the segment before each joint
    rounded: list[bool] = []
    rests: list[list[Shape]] = []  # what else each link has
    for number, shapes in enumerate((root, *(link.shapes for link in links))):
        rests.append(list(shapes))
        if not shapes:
            name = "the root" if number == 0 else f"link '{links[number - 1].name}'"
            raise NotADefinitionError(f"{name} has no shape")
        if number < count:
            rounded.append(_take_filler(rests[-1], joints[number].hinge, NEAR * size))
            below.append(rests[-1].pop())
    above: list[Shape] = []  # the segment after each joint
    for number, rest in enumerate(rests[1:], start=1):
        above.append(rest.pop(0) if rest else below[number])
        if rest and number < count:
            raise NotADefinitionError(
                f"link '{links[number - 1].name}' has {len(rest) + 2} shapes; between two joints "
                "there is one, and two where an actuator ends"
            )
    starts = [0] + [one for one in range(1, count) if below[one] is not above[one - 1]]
    actuators = tuple(
        SplitActuator(
            first,
            last,
            (*below[first:last], above[last - 1]),
            any(rounded[first:last]),
        )
        for first, last in zip(starts, [*starts[1:], count], strict=True)
    )
    return SplitLimb(tuple(rests[0]), actuators, tuple(rests[-1]))


def _take_filler(shapes: list[Shape], hinge: Vector, tolerance: float) -> bool:
    """Take away the shape that fills the gap at a hinge, if there is one."""
    if len(shapes) < 2:
        return False
    filler, segment = shapes[-1], shapes[-2]
    is_there = geometry.norm(geometry.subtract(filler.position, hinge)) <= tolerance
    is_ball = isinstance(filler.solid, Sphere) and isinstance(segment.solid, Cylinder)
    is_roll = isinstance(filler.solid, Cylinder) and isinstance(segment.solid, Box)
    if is_there and (is_ball or is_roll):
        shapes.pop()
        return True
    return False
