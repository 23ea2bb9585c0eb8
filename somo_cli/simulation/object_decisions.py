"""The decisions of a plan about files of objects: hulls of meshes, and mended inertias."""

from __future__ import annotations

from collections.abc import Iterator

from somo_cli.manipulator.hull import Hull
from somo_cli.simulation.decision import Decision, count_of
from somo_cli.simulation.plan.model import Plan


def object_decisions(plan: Plan) -> Iterator[Decision]:
    """Yield the number of hulls that stand for meshes, and inertias that differ from the file."""
    hulls = {
        one.rigid_object.name: sum(
            isinstance(shape.solid, Hull) for shape in one.rigid_object.chain.links[0].shapes
        )
        for one in plan.objects
        if one.rigid_object.collides
    }
    counted = [f"{name} by {count_of(count, 'hull')}" for name, count in hulls.items() if count]
    if counted:
        what = "meshes as they are, in contact"
        yield Decision(what, False, f"the engine takes convex shapes: {', '.join(counted)}")
    mended = [
        f"of {one.rigid_object.name} {one.rigid_object.mended_inertias}"
        for one in plan.objects
        if one.rigid_object.mended_inertias and not one.rigid_object.has_prescribed_pose
    ]
    if mended:
        why = "no body has them, by what rounding to three digits makes; the nearest possible one"
        yield Decision("inertias as they are given", False, f"{why}: {'; '.join(mended)}")
