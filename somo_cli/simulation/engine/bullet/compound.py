"""A compound in PyBullet: write its meshes, create its shapes and its body."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from somo_cli.manipulator import geometry
from somo_cli.manipulator.urdf import number
from somo_cli.scene.compound import MAX_SHAPES, Compound, EngineShape
from somo_cli.simulation.engine.bullet.client import BulletClient


def create_body(engine: BulletClient, compound: Compound, stem: str, is_fixed: bool) -> int:
    """Create the body, in the frame of its principal axes, and return its index.

    Meshes are written to files whose paths start with `stem`. Raises the error of the engine.
    """
    if len(compound.shapes) > MAX_SHAPES:
        return _create_by_urdf(engine, compound, stem, is_fixed)
    kinds = {
        "box": engine.GEOM_BOX,
        "sphere": engine.GEOM_SPHERE,
        "cylinder": engine.GEOM_CYLINDER,
        "capsule": engine.GEOM_CAPSULE,
        "mesh": engine.GEOM_MESH,
    }
    names = []
    for index, shape in enumerate(compound.shapes):
        names.append(f"{stem}_{index}.obj" if shape.obj else "")
        if shape.obj:
            Path(names[-1]).write_text(shape.obj, encoding="utf-8")
    shapes = engine.createCollisionShapeArray(
        shapeTypes=[kinds[shape.kind] for shape in compound.shapes],
        radii=[shape.radius for shape in compound.shapes],
        lengths=[shape.length for shape in compound.shapes],
        halfExtents=[shape.half_extents for shape in compound.shapes],
        fileNames=names,
        meshScales=[[1, 1, 1]] * len(names),
        collisionFramePositions=[shape.position for shape in compound.shapes],
        collisionFrameOrientations=[shape.orientation_xyzw for shape in compound.shapes],
    )
    mass = 0.0 if is_fixed else compound.mass
    body: int = engine.createMultiBody(mass, shapes, -1, [0, 0, 0])
    return _with_properties(engine, compound, body, is_fixed)


def _with_properties(engine: BulletClient, compound: Compound, index: int, is_fixed: bool) -> int:
    """Give a body the margin and the inertia of the compound; return its index."""
    # seen in 3.2.7: a hull has a collision margin of 0.001 engine units by default. This call
    # changes it for shapes made here, but not for several or shifted shapes of a URDF
    engine.changeDynamics(index, -1, collisionMargin=compound.margin)
    if not is_fixed:
        # the engine's own inertia is that of the box around the shapes
        engine.changeDynamics(index, -1, localInertiaDiagonal=compound.moments)
    return index


def _create_by_urdf(engine: BulletClient, compound: Compound, stem: str, is_fixed: bool) -> int:
    """Make a body of more than MAX_SHAPES shapes by a URDF, which takes any number of them."""
    path = Path(f"{stem}.urdf")
    path.write_text(_urdf_text(compound), encoding="utf-8")
    flags = engine.URDF_USE_INERTIA_FROM_FILE | engine.URDF_USE_IMPLICIT_CYLINDER
    index: int = engine.loadURDF(str(path), useFixedBase=is_fixed, flags=flags)
    return _with_properties(engine, compound, index, is_fixed)


def _urdf_text(compound: Compound) -> str:
    """Return a URDF with one link that has these shapes, in its principal axes."""
    a, b, c = map(number, compound.moments)
    inertia = f'<inertia ixx="{a}" iyy="{b}" izz="{c}" ixy="0" ixz="0" iyz="0"/>'
    shapes = "\n".join(map(_collision_element, compound.shapes))
    return (
        '<robot name="compound"><link name="link"><inertial>'
        f'<mass value="{number(compound.mass)}"/>{inertia}</inertial>\n{shapes}\n</link></robot>\n'
    )


def _collision_element(shape: EngineShape) -> str:
    turn = geometry.rotation_from_quaternion(shape.orientation_xyzw)
    size = {
        "box": f'size="{_numbers([2 * one for one in shape.half_extents])}"',
        "sphere": f'radius="{number(shape.radius)}"',
        "cylinder": f'radius="{number(shape.radius)}" length="{number(shape.length)}"',
        "capsule": f'radius="{number(shape.radius)}" length="{number(shape.length)}"',
    }[shape.kind]
    place, rpy = _numbers(shape.position), _numbers(geometry.rpy_from_rotation(turn))
    origin = f'<origin xyz="{place}" rpy="{rpy}"/>'
    return f"<collision>{origin}<geometry><{shape.kind} {size}/></geometry></collision>"


def _numbers(values: Sequence[float]) -> str:
    return " ".join(map(number, values))
