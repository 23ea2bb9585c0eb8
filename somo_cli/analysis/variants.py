"""The same scene with another step, integrator or number of segments."""

from __future__ import annotations

import dataclasses

from somo_cli.manipulator import geometry, segments
from somo_cli.manipulator.chain import Chain
from somo_cli.simulation.columns import groups
from somo_cli.simulation.plan import make_plan
from somo_cli.simulation.scene import Integrator, Load, Manipulator, Quantity, Scene

ALWAYS: tuple[Quantity, ...] = ("tip_position", "joint_angles", "energy")
"""What a study compares whatever the scene records."""


def studied(scene: Scene) -> Scene:
    """Return the scene recording what a study compares, and what it records of manipulators.

    Whole quantities, and to the end of the study's time: where conditions would end variants at
    different instants nothing could be compared. Of a scene that picks columns from all quantities
    those with a picked column.
    """
    picked = (group.quantity for group in groups(make_plan(scene)))
    columns = tuple(dict.fromkeys((*ALWAYS, *picked)))
    return dataclasses.replace(scene, columns=columns, of_things=(), only=(), stops=())


def stepped(scene: Scene, integrator: Integrator, time_step: float, every: int) -> Scene:
    """Return the scene with another integrator and step [s]."""
    return dataclasses.replace(scene, integrator=integrator, time_step=time_step, every=every)


def cut(scene: Scene, count: int) -> Scene:
    """Return the scene with `count` segments in every actuator, the continuum kept.

    Raises segments.NotUniform, its message starting with the name of the manipulator.
    """
    return dataclasses.replace(
        scene, manipulators=tuple(_cut(one, count) for one in scene.manipulators)
    )


def _cut(one: Manipulator, count: int) -> Manipulator:
    compiled = one.compiled
    try:
        anew = segments.cut(compiled, count)
        return dataclasses.replace(
            one,
            compiled=anew,
            initial_angles=segments.per_joint(one.initial_angles, compiled, anew),
            initial_rates=segments.per_joint(one.initial_rates, compiled, anew),
            loads=tuple(_moved(load, compiled.chain, anew.chain) for load in one.loads),
        )
    except segments.NotUniform as error:
        raise segments.NotUniform(f"'{one.name}' cannot be cut into {count}: {error}") from error


def _moved(load: Load, before: Chain, after: Chain) -> Load:
    """Return a load on the base or on the last link of a limb, at the same place from the tip."""
    if load.link == 0:
        return load
    for old, new in zip(before.backbones, after.backbones, strict=True):
        if load.link == old.last_link:
            point = geometry.add(new.tip, geometry.subtract(load.point, old.tip))
            return dataclasses.replace(load, link=new.last_link, point=point)
    link = before.links[load.link].name
    raise segments.NotUniform(f"there is a load on {link}, which may have no counterpart")
