"""Make the plan of a run from its scene: all that the engine needs, in its units, and no more."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.manipulator import urdf
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import (
    Dimension,
    Scale,
    scaled,
)
from somo_cli.scene import compound, reach, signals
from somo_cli.scene.actuation import Actuation
from somo_cli.scene.model import (
    Base,
    ExternalLoad,
    Integrator,
    Manipulator,
    Scene,
)
from somo_cli.scene.placement import with_heights
from somo_cli.scene.rigid_object import RigidObject
from somo_cli.simulation.plan.model import (
    ActuatorTorque,
    Body,
    InitialState,
    Plan,
    PlannedLoad,
    PlannedObject,
)
from somo_cli.simulation.plan.units import TORQUE


@dataclass(frozen=True, slots=True)
class LoadOptions:
    """Which parts of a body the engine loads."""

    has_collisions: bool
    """Whether it gets the collision shapes."""
    has_visuals: bool
    """Whether it gets the visual shapes as well."""
    has_limits: bool
    """Whether it gets the limits of joints."""
    has_zero_torque_motors: bool
    """Whether joints without dry friction keep a solver row, which has no effect."""

    @staticmethod
    def of(
        manipulator: Manipulator, scene: Scene, can_touch: bool, keeps_unused: bool
    ) -> LoadOptions:
        """Return the parts that a result depends on, or all if `keeps_unused`."""
        return LoadOptions(
            has_collisions=keeps_unused or can_touch,
            has_visuals=keeps_unused,
            has_limits=keeps_unused
            or needs_engine_limits(can_touch, scene.integrator, manipulator.base),
            has_zero_torque_motors=keeps_unused,
        )


def make_plan(scene: Scene, keeps_unused: bool = False) -> Plan:
    """Return the plan of a scene, converted from SI to engine units here and nowhere else.

    With `keeps_unused` the engine also loads the shapes, solves the rows and reads the state that
    no result needs.
    """
    acceleration = scene.scale.factor(Dimension(length=1, time=-2))
    can_touch = reach.can_touch(scene)
    gx, gy, gz = scene.gravity
    return Plan(
        scale=scene.scale,
        time_step=scene.time_step,
        gravity=(gx * acceleration, gy * acceleration, gz * acceleration),
        integrator=scene.integrator,
        bodies=tuple(
            _body(one, scene.scale, LoadOptions.of(one, scene, can_touch, keeps_unused))
            for one in scene.manipulators
        ),
        every=scene.every,
        columns=scene.columns,
        ground=None if scene.ground is None else scaled(scene.ground, scene.scale),
        objects=tuple(
            _planned_object(one, scene.scale, keeps_unused)
            for one in with_heights(scene.objects, scene.ground)
        ),
        object_quantities=scene.object_quantities if scene.objects else (),
        only=scene.only,
        stop_conditions=tuple(scaled(one, scene.scale) for one in scene.stop_conditions),
        records_last_step=bool(scene.stop_conditions),
        can_touch=can_touch,
        keeps_unused=keeps_unused,
    )


def needs_engine_limits(can_touch: bool, integrator: Integrator, base: Base) -> bool:
    """Return whether the joints of a body need the engine's own limits.

    A contact or a moving base can push a joint beyond the limit that the implicit law holds. The
    explicit law holds no limits.
    """
    return can_touch or integrator == "explicit" or base != "static"


def _body(manipulator: Manipulator, scale: Scale, options: LoadOptions) -> Body:
    chain = scaled(manipulator.compiled.chain, scale)
    start = InitialState(
        manipulator.position,
        manipulator.rpy,
        manipulator.linear_velocity,
        manipulator.angular_velocity,
        manipulator.initial_angles,
        manipulator.initial_rates,
    )
    start, motion = scaled(start, scale), manipulator.motion
    return Body(
        name=manipulator.name,
        base=manipulator.base,
        chain=chain,
        urdf=urdf.render_for_engine(
            chain,
            with_collisions=options.has_collisions,
            with_visuals=options.has_visuals,
            with_limits=options.has_limits,
        ),
        start=start,
        drives=tuple(_actuator_torque(entry, chain, scale) for entry in manipulator.actuation),
        loads=tuple(_planned_load(scaled(entry, scale)) for entry in manipulator.loads),
        surfaces=scaled(manipulator.surfaces, scale),
        has_self_collision=manipulator.has_self_collision,
        path=None if motion is None else scaled(motion, scale).path_from(start.pose),
        has_engine_limits=options.has_limits,
        has_zero_torque_motors=options.has_zero_torque_motors,
    )


def _planned_object(one: RigidObject, scale: Scale, keeps_unused: bool) -> PlannedObject:
    rigid_object = scaled(one, scale)
    motion = rigid_object.motion
    path = None if motion is None else motion.path_from(rigid_object.pose)
    (link,) = rigid_object.chain.links
    if not compound.is_exact_in_urdf(link):
        return PlannedObject(rigid_object, "", compound.compound_of(link), path)
    text = urdf.render_for_engine(
        rigid_object.chain, with_collisions=True, with_visuals=keeps_unused
    )
    return PlannedObject(rigid_object, text, path=path)


def _actuator_torque(actuation: Actuation, chain: Chain, scale: Scale) -> ActuatorTorque:
    joints = tuple(
        index
        for index, joint in enumerate(chain.joints)
        if (joint.actuator, joint.channel) == (actuation.actuator, actuation.axis)
    )
    return ActuatorTorque(
        actuation.actuator,
        actuation.axis,
        joints,
        actuation.profile.scaled(scale.factor(TORQUE)).signal(),
        actuation.profile.signal(),
    )


def _planned_load(load: ExternalLoad) -> PlannedLoad:
    factor = signals.piecewise_signal(load.waypoints, load.interpolation, load.repeat)
    return PlannedLoad(load.link, load.point, load.force, load.moment, load.frame, factor)
