"""Describe an object for the engine: shapes in the frame of its principal axes of inertia."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Link, Shape
from somo_cli.manipulator.geometry import Matrix, Tensor, Vector
from somo_cli.manipulator.hull import Hull
from somo_cli.manipulator.kinematics import Pose
from somo_cli.manipulator.round_solids import Capsule, RoundedBox
from somo_cli.manipulator.solids import AnySolid, Box, Cylinder, Sphere
from somo_cli.manipulator.urdf import number

MAX_SHAPES = 16
"""Seen in PyBullet 3.2.7: createCollisionShapeArray drops further shapes without an error. A URDF
may have more, but its hulls keep a margin of 0.001 engine units, whatever is set."""

_NEAR = 1e-9  # difference of the largest moment from half the sum of all, divided by the sum
_PRODUCT_TOLERANCE = 1e-12  # product of inertia that is rounding, divided by the largest moment
_NO_ROTATION = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class EngineShape:
    """One collision shape and its pose in the frame of the compound.

    `obj` is the text of a mesh. The length unit is that of the link; a kind ignores the sizes of
    the others.
    """

    kind: Literal["box", "sphere", "cylinder", "capsule", "mesh"]
    position: Vector = geometry.ZERO
    orientation_xyzw: tuple[float, float, float, float] = _NO_ROTATION
    radius: float = 1.0
    length: float = 1.0
    half_extents: Vector = (1.0, 1.0, 1.0)
    obj: str = ""


@dataclass(frozen=True, slots=True)
class Compound:
    """A body of several shapes, or of one shape that the engine cannot read exactly from a URDF.

    `frame` is the pose of the principal axes, at the centre of mass, in the object's frame;
    `moments` are the moments of inertia about these axes. `margin` is the thickness that the engine
    adds around every mesh, in the length unit of the shapes.
    """

    frame: Pose
    mass: float
    moments: Vector
    margin: float
    shapes: tuple[EngineShape, ...]


def is_exact_in_urdf(link: Link) -> bool:
    """Return whether the engine reads the link exactly from a URDF.

    It does for one box, cylinder or sphere at the link's origin. Seen in 3.2.7: if one moment of
    inertia exceeds the sum of the others, if only by rounding, the engine sets the inertia to zero,
    and the body cannot rotate.
    """
    xx, xy, xz, yy, yz, zz = link.inertial.inertia
    if xy or xz or yz or 2 * max(xx, yy, zz) > (1 - _NEAR) * (xx + yy + zz):
        return False
    return (
        len(link.shapes) == 1
        and isinstance(link.shapes[0].solid, Box | Cylinder | Sphere)
        and (link.shapes[0].position == link.shapes[0].rpy == link.inertial.centre == geometry.ZERO)
    )


def compound_of(link: Link) -> Compound:
    """Return the link of an object as a compound, in the units of the link."""
    axes, moments = principal_axes(link.inertial.inertia)
    frame = Pose(link.inertial.centre, axes)
    radii = [one.solid.radius for one in link.shapes if isinstance(one.solid, RoundedBox)]
    shapes = [part for shape in link.shapes for part in _engine_shapes(shape, frame)]
    if len(shapes) > MAX_SHAPES:  # without hulls they are as they were: a URDF takes any number
        shapes = _with_hulls_in_one(link, frame)
    return Compound(
        frame,
        link.inertial.mass,
        moments,
        # a rounded box is the only shape of its body, so the margin affects no other
        max(radii, default=0.0),
        tuple(shapes),
    )


def _with_hulls_in_one(link: Link, frame: Pose) -> list[EngineShape]:
    """Return the shapes, with all hulls as named parts of one mesh.

    Seen in 3.2.7: each named part of an OBJ becomes a convex shape, and MAX_SHAPES does not apply.
    """
    hulls = [shape for shape in link.shapes if isinstance(shape.solid, Hull)]
    others = [shape for shape in link.shapes if not isinstance(shape.solid, Hull)]
    lines: list[str] = []
    start = 0
    for index, shape in enumerate(hulls):
        solid = shape.solid
        assert isinstance(solid, Hull)
        position, rotation = _place(shape, frame)
        pose = Pose(position, rotation)
        points = [pose.point(vertex) for vertex in solid.vertices]
        lines += [f"o part_{index}", _obj_text(points, solid.faces, start)]
        start += len(points)
    parts = [part for shape in others for part in _engine_shapes(shape, frame)]
    return [*parts, EngineShape("mesh", obj="\n".join(lines))] if hulls else parts


def _place(shape: Shape, frame: Pose) -> tuple[Vector, Matrix]:
    """Return position and rotation of a shape in the frame of the principal axes."""
    inverse = geometry.transposed(frame.rotation)
    position = geometry.rotate(inverse, geometry.subtract(shape.position, frame.position))
    return position, geometry.multiply(inverse, geometry.rotation_from_rpy(shape.rpy))


def shape_count(solids: Sequence[AnySolid]) -> int:
    """Return how many shapes of the engine these solids need.

    A capsule needs three; beyond MAX_SHAPES all hulls together need one.
    """
    count = sum(3 if isinstance(solid, Capsule) else 1 for solid in solids)
    hulls = sum(isinstance(solid, Hull) for solid in solids)
    return count if count <= MAX_SHAPES else count - max(0, hulls - 1)


def is_too_much(solids: Sequence[AnySolid]) -> bool:
    """Whether the engine can take these solids in no way: hulls, and many others with them."""
    return any(isinstance(solid, Hull) for solid in solids) and shape_count(solids) > MAX_SHAPES


def principal_axes(tensor: Tensor) -> tuple[Matrix, Vector]:
    """Return the principal axes of an inertia tensor, as columns, and the moments about them."""
    xx, xy, xz, yy, yz, zz = tensor
    if max(abs(xy), abs(xz), abs(yz)) <= _PRODUCT_TOLERANCE * max(xx, yy, zz):
        return geometry.IDENTITY, (xx, yy, zz)
    import numpy as np  # imported here because it is slow to load and few bodies need it

    moments, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    x, y, z = (geometry.vector(row) for row in axes.tolist())
    return (x, y, z), geometry.vector(moments.tolist())


def _engine_shapes(shape: Shape, frame: Pose) -> list[EngineShape]:
    position, rotation = _place(shape, frame)
    turn = geometry.quaternion_from_rotation(rotation)
    solid = shape.solid
    if isinstance(solid, Box):
        x, y, z = solid.size
        return [EngineShape("box", position, turn, half_extents=(x / 2, y / 2, z / 2))]
    if isinstance(solid, Sphere):
        return [EngineShape("sphere", position, turn, solid.radius)]
    if isinstance(solid, Cylinder):
        return [EngineShape("cylinder", position, turn, solid.radius, solid.length)]
    if isinstance(solid, Capsule):
        # seen in 3.2.7: a capsule alone has one contact point with a plane, which jumps from end
        # to end while it rolls and speeds it up by a sixth in a second; with a sphere in each end
        # it has a contact point at both
        along = geometry.rotate(rotation, (0.0, 0.0, solid.length / 2))
        return [
            EngineShape("capsule", position, turn, solid.radius, solid.length),
            EngineShape("sphere", geometry.add(position, along), turn, solid.radius),
            EngineShape("sphere", geometry.subtract(position, along), turn, solid.radius),
        ]
    if isinstance(solid, RoundedBox):
        # the core with a margin of the edge radius is exactly the rounded box
        corners = product(*((-half, half) for half in solid.core))
        return [EngineShape("mesh", position, turn, obj=_obj_text(tuple(corners), _BOX_FACES))]
    return [EngineShape("mesh", position, turn, obj=_obj_text(solid.vertices, solid.faces))]


_BOX_FACES = (
    *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5)),
    *((0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)),
    *((0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
)


def _obj_text(
    vertices: Sequence[Sequence[float]], faces: Sequence[tuple[int, int, int]], start: int = 0
) -> str:
    lines = ["v " + " ".join(map(number, vertex)) for vertex in vertices]
    first = start + 1
    lines += [f"f {a + first} {b + first} {c + first}" for a, b, c in faces]
    return "\n".join(lines) + "\n"
