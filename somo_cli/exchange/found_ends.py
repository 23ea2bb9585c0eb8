"""Find the definitions of bases, bodies and tips: parts whose free ends may be rounded."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from somo_cli.exchange.found_parts import (
    SAME,
    Data,
    difference,
    kind_of,
    link_data,
)
from somo_cli.exchange.split_limb import NotADefinitionError
from somo_cli.manipulator import geometry, solids
from somo_cli.manipulator.chain import Shape
from somo_cli.manipulator.solids import Box, Cylinder, Inertial, Sphere


@dataclass(frozen=True, slots=True)
class EndPart:
    """A shape with mass at an end of a limb, and whether a shape without mass rounds its end."""

    shape: Shape
    is_rounded: bool

    @property
    def height(self) -> float:
        """Its extent along the backbone."""
        return self.shape.solid.height


def end_parts(shapes: Sequence[Shape]) -> list[EndPart]:
    """Return the parts that shapes in a row are, each round end with the part before it."""
    found: list[EndPart] = []
    for shape in shapes:
        if found and _is_cap(shape, found[-1].shape):
            found[-1] = EndPart(found[-1].shape, True)
        else:
            found.append(EndPart(shape, False))
    return found


def _is_cap(cap: Shape, part: Shape) -> bool:
    """Whether a shape is the round end of a part: in the middle of one of its end faces."""
    axis = geometry.rotate(geometry.rotation_from_rpy(part.rpy), (0.0, 0.0, 1.0))
    apart = geometry.subtract(cap.position, part.position)
    along = abs(geometry.dot(apart, axis))
    aside = math.sqrt(max(0.0, geometry.dot(apart, apart) - along**2))
    half = part.solid.height / 2
    if abs(along - half) > SAME * half or aside > 1e-6 * half:
        return False
    if isinstance(part.solid, Cylinder):
        return isinstance(cap.solid, Sphere) and _is_close(cap.solid.radius, part.solid.radius)
    return (
        isinstance(part.solid, Box)
        and isinstance(cap.solid, Cylinder)
        and _is_close(cap.solid.radius, part.solid.size[1] / 2)
        and _is_close(cap.solid.length, part.solid.size[0])
    )


def _is_close(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=SAME)


def end_data(
    parts: Sequence[EndPart], whole: Inertial, others: Sequence[Inertial], start: float, size: float
) -> list[Data]:
    """Return the definitions of parts that all stand at height `start`, as tips do.

    They have what is left of the mass properties of a rigid body without `others`. Of two parts the
    first is homogeneous. Raises NotADefinitionError.
    """
    left = difference(whole, solids.lumped(tuple(others))) if others else whole
    scale = max(map(abs, whole.inertia))
    inertials = [left]
    if len(parts) > 1:
        inertials = _shared(parts, left)
    data = []
    for part, inertial in zip(parts, inertials, strict=True):
        middle = (0.0, 0.0, start + part.height / 2)
        offset = geometry.subtract(part.shape.position, middle)
        kind = kind_of(part.shape.solid, part.is_rounded)
        data.append(link_data(part.shape, kind, inertial, offset, size, scale))
    return data


def homogeneous(shape: Shape, mass: float) -> Inertial:
    """Return the mass properties of a homogeneous shape in the frame that it is given in."""
    assert isinstance(shape.solid, Box | Cylinder | Sphere)
    own = Inertial(mass, geometry.ZERO, shape.solid.inertia(mass))
    return solids.placed(own, shape.position, geometry.rotation_from_rpy(shape.rpy))


def _shared(parts: Sequence[EndPart], whole: Inertial) -> list[Inertial]:
    """Return the mass properties of two parts that have those of a rigid body together.

    The centre of mass tells their masses; in one place they have one density.
    """
    if len(parts) > 2:
        raise NotADefinitionError("the masses of more than two tips cannot be told apart")
    one, other = (part.shape for part in parts)
    between = geometry.subtract(other.position, one.position)
    squared = geometry.dot(between, between)
    apart = geometry.subtract(whole.centre, one.position)
    if math.sqrt(squared) > SAME * one.solid.circumradius:
        share = geometry.dot(apart, between) / squared
    else:
        share = _volume(other) / (_volume(one) + _volume(other))
    if not 0 < share < 1:
        raise NotADefinitionError("a tip would have no mass")
    first = homogeneous(one, whole.mass * (1 - share))
    return [first, difference(whole, first)]


def _volume(shape: Shape) -> float:
    assert isinstance(shape.solid, Box | Cylinder | Sphere)
    return shape.solid.volume
