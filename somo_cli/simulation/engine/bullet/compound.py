"""A compound in PyBullet: its meshes written, its shapes and its body made."""

from __future__ import annotations

from pathlib import Path

from somo_cli.scene.compound import Compound
from somo_cli.simulation.engine.bullet.client import BulletClient


def create_body(engine: BulletClient, compound: Compound, stem: str, is_fixed: bool) -> int:
    """Make the body, in the frame of its principal axes, and return its index.

    Meshes are written to files that start with `stem`. Raises the engine's error.
    """
    kinds = {
        "box": engine.GEOM_BOX,
        "sphere": engine.GEOM_SPHERE,
        "cylinder": engine.GEOM_CYLINDER,
        "capsule": engine.GEOM_CAPSULE,
        "mesh": engine.GEOM_MESH,
    }
    names = []
    for number, shape in enumerate(compound.shapes):
        names.append(f"{stem}_{number}.obj" if shape.obj else "")
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
    index: int = engine.createMultiBody(mass, shapes, -1, [0, 0, 0])
    # seen in 3.2.7: a hull floats on a margin of 0.001 engine units unless told otherwise, which
    # works for shapes made here, but not for those of a URDF with several or with an offset
    engine.changeDynamics(index, -1, collisionMargin=compound.margin)
    if not is_fixed:
        # the engine's own inertia is that of the box around the shapes
        engine.changeDynamics(index, -1, localInertiaDiagonal=compound.moments)
    return index
