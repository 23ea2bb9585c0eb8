"""A scene with another time step, integrator or number of segments."""

from __future__ import annotations

import dataclasses

from somo_cli.manipulator import geometry, resegmentation
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import Compiled
from somo_cli.scene.columns import body_column_groups, header, object_column_groups
from somo_cli.scene.model import ExternalLoad, Integrator, Manipulator, Quantity, Scene
from somo_cli.scene.rigid_object import ObjectQuantity
from somo_cli.simulation.plan.build import make_plan

ALWAYS_COMPARED: tuple[Quantity, ...] = ("tip_position", "joint_angles", "energy")
"""Quantities that a study compares even if the scene does not record them."""


def study_variant(scene: Scene) -> Scene:
    """Return the scene with the recorded quantities that a study compares, and no stop conditions.

    They are ALWAYS_COMPARED, the poses of objects, the forces of all pairs that can touch, and
    every quantity of which the scene records a column, each with all its columns. Variants that
    stop at different instants could not be compared.
    """
    plan = make_plan(scene)
    picked = (group.quantity for group in body_column_groups(plan.recorded))
    picked_of_objects = (group.quantity for group in object_column_groups(plan.recorded))
    pairs: tuple[Quantity, ...] = ("contact_pairs",) if plan.can_touch else ()
    pairs_of_objects: tuple[ObjectQuantity, ...] = ("contact_pairs",) if plan.can_touch else ()
    of_objects = dict.fromkeys(("pose", *pairs_of_objects, *picked_of_objects))
    return dataclasses.replace(
        scene,
        columns=tuple(dict.fromkeys((*ALWAYS_COMPARED, *pairs, *picked))),
        object_quantities=tuple(of_objects) if plan.objects else (),
        only=(),
        stop_conditions=(),
    )


def recorded_names(variant: Scene, scene: Scene) -> frozenset[str]:
    """Return the names of the columns that a variant has if it records what the scene does."""
    own = dataclasses.replace(
        variant,
        columns=scene.columns,
        object_quantities=scene.object_quantities,
        only=scene.only,
    )
    return frozenset(header(make_plan(own).recorded)[1:])


def with_time_step(scene: Scene, integrator: Integrator, time_step: float, every: int) -> Scene:
    """Return the scene with another integrator and step [s]."""
    return dataclasses.replace(scene, integrator=integrator, time_step=time_step, every=every)


def with_segments(scene: Scene, count: int) -> Scene:
    """Return the scene with `count` segments in every actuator that stand for the same continuum.

    Raises resegmentation.NotUniform, its message starting with the name of the manipulator.
    """
    return dataclasses.replace(
        scene,
        manipulators=tuple(_manipulator_with_segments(one, count) for one in scene.manipulators),
    )


def _manipulator_with_segments(one: Manipulator, count: int) -> Manipulator:
    compiled = one.compiled
    try:
        anew = resegmentation.cut(compiled, count)
        return dataclasses.replace(
            one,
            compiled=anew,
            initial_angles=_angles_with_segments(one.initial_angles, compiled, anew),
            initial_rates=resegmentation.per_joint(one.initial_rates, compiled, anew),
            loads=tuple(_moved_load(load, compiled.chain, anew.chain) for load in one.loads),
        )
    except resegmentation.NotUniform as error:
        raise resegmentation.NotUniform(
            f"'{one.name}' cannot be divided into {count} segments: {error}"
        ) from error


def _angles_with_segments(
    angles: tuple[float, ...], before: Compiled, after: Compiled
) -> tuple[float, ...]:
    """Return the angles at the start for other joints; relaxed springs stay exactly relaxed."""
    if angles == before.chain.neutral_angles:
        return after.chain.neutral_angles
    return resegmentation.per_joint(angles, before, after)


def _moved_load(load: ExternalLoad, before: Chain, after: Chain) -> ExternalLoad:
    """Return a load at the same position from the tip; it acts on a base or on a last link."""
    if load.link == 0:
        return load
    for old, new in zip(before.backbones, after.backbones, strict=True):
        if load.link == old.last_link:
            point = geometry.add(new.tip, geometry.subtract(load.point, old.tip))
            return dataclasses.replace(load, link=new.last_link, point=point)
    link = before.links[load.link].name
    raise resegmentation.NotUniform(
        f"a load acts on {link}, which has no counterpart with another number of segments"
    )
