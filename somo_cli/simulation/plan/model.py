"""Everything the scene needs, decided before any engine starts, in the engine's units."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.manipulator import urdf
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import (
    Acceleration,
    Angle,
    AngularRate,
    Dimension,
    Length,
    Scale,
    Velocity,
    scaled,
)
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene import compound, reach, signals
from somo_cli.scene.actuation import Actuation
from somo_cli.scene.columns import Recorded
from somo_cli.scene.compound import Compound
from somo_cli.scene.contact_surface import ContactSurface, Ground, ManipulatorSurfaces
from somo_cli.scene.model import (
    Base,
    ExternalLoad,
    Frame,
    Integrator,
    Manipulator,
    Quantity,
    Scene,
)
from somo_cli.scene.placement import with_heights
from somo_cli.scene.prescribed_motion import PosePath, PrescribedMotion
from somo_cli.scene.rigid_object import ObjectQuantity, RigidObject
from somo_cli.scene.signals import PiecewiseSignal, Signal
from somo_cli.scene.stop_conditions import StopCondition

TORQUE = Dimension(mass=1, length=2, time=-2)


@dataclass(frozen=True, slots=True)
class ActuatorTorque:
    """A torque over time and the joints of one body that it acts on.

    `signal` is in engine units, as it acts; `si_signal` [N·m] is what is recorded of it, which no
    scaling has rounded.
    """

    actuator: int
    axis: int
    joints: tuple[int, ...]
    signal: Signal
    si_signal: Signal


@dataclass(frozen=True, slots=True)
class PlannedLoad:
    """A force and a moment on one link of a body [engine units], times a factor over time.

    `link` counts the links of the chain; point and frame are as in the scene.
    """

    link: int
    point: Vector
    force: Vector
    moment: Vector
    frame: Frame
    signal: PiecewiseSignal


@dataclass(frozen=True, slots=True)
class InitialState:
    """Pose and motion of a body at time zero, in engine units; the base frame's, in the world."""

    position: tuple[Length, Length, Length]
    rpy: tuple[Angle, Angle, Angle]
    linear_velocity: tuple[Velocity, Velocity, Velocity]
    angular_velocity: tuple[AngularRate, AngularRate, AngularRate]
    angles: tuple[Angle, ...]
    rates: tuple[AngularRate, ...]

    @property
    def pose(self) -> Pose:
        """The pose of the base frame in the world."""
        return Pose.of(self.position, self.rpy)


@dataclass(frozen=True, slots=True)
class Body:
    """One manipulator, ready to load: `chain` in engine units, and the URDF of it.

    The URDF has no shapes where nothing can touch: shapes cost the engine time and change
    nothing, since every inertia is in the file.
    """

    name: str
    base: Base
    chain: Chain
    urdf: str
    start: InitialState
    drives: tuple[ActuatorTorque, ...]
    loads: tuple[PlannedLoad, ...]
    surfaces: ManipulatorSurfaces
    has_self_collision: bool
    path: PosePath | None = None
    """Where the base is at every time, if it is moved."""
    has_engine_limits: bool = True
    """Whether the engine knows the limits of joints, as the law always does."""
    has_zero_torque_motors: bool = False
    """Whether joints without dry friction have a row of the solver as well, of no effect."""


@dataclass(frozen=True, slots=True)
class PlannedObject:
    """One object, ready to load: in engine units, the URDF of it, or a compound instead.

    With its path if it is moved.
    """

    rigid_object: RigidObject
    urdf: str
    compound: Compound | None = None
    path: PosePath | None = None


@dataclass(frozen=True, slots=True)
class Plan:
    """The whole run: bodies, gravity [engine units], time step [s], and what is recorded."""

    scale: Scale
    time_step: float
    gravity: tuple[Acceleration, Acceleration, Acceleration]
    integrator: Integrator
    bodies: tuple[Body, ...]
    every: int
    columns: tuple[Quantity, ...]
    ground: Ground | None
    objects: tuple[PlannedObject, ...]
    object_quantities: tuple[ObjectQuantity, ...]
    can_touch: bool
    """Whether there is anything within reach that a body could touch, itself included."""
    only: tuple[str, ...] = ()
    stop_conditions: tuple[StopCondition, ...] = ()
    records_last_step: bool = False
    """Whether the last step is recorded wherever it falls; so where a stop may end the run."""
    keeps_unused: bool = False
    """Whether shapes are loaded, rows are solved and state is read that no result needs."""

    @property
    def recorded(self) -> Recorded:
        """What is recorded, and of what: all that the columns depend on."""
        return Recorded(
            tuple((body.name, body.chain) for body in self.bodies),
            tuple(planned.rigid_object.name for planned in self.objects),
            self.ground is not None,
            self.columns,
            self.object_quantities,
            self.only,
        )

    @property
    def surfaces(self) -> tuple[ContactSurface, ...]:
        """Every surface of the scene but the ground's."""
        own = (one for body in self.bodies for one in body.surfaces.all)
        return (*own, *(planned.rigid_object.surface for planned in self.objects))


def make_plan(scene: Scene, keeps_unused: bool = False) -> Plan:
    """Return the plan of a scene; the only place where SI becomes engine units.

    With `keeps_unused` shapes are loaded, rows are solved and state is read that no result
    needs.
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
            _body(
                one,
                scene.scale,
                can_touch or keeps_unused,
                keeps_unused,
                keeps_unused or needs_engine_limits(can_touch, scene.integrator, one.base),
                keeps_unused,
            )
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
    """Whether the law alone would not stop the joints of a body at their limits.

    Pushed by what moves, they get beyond, and the explicit law stops none.
    """
    return can_touch or integrator == "explicit" or base != "static"


def _body(
    manipulator: Manipulator,
    scale: Scale,
    with_collisions: bool,
    with_visuals: bool,
    with_limits: bool,
    with_motors: bool,
) -> Body:
    chain = scaled(manipulator.compiled.chain, scale)
    start = InitialState(
        manipulator.position,
        manipulator.rpy,
        manipulator.linear_velocity,
        manipulator.angular_velocity,
        manipulator.initial_angles,
        manipulator.initial_rates,
    )
    start = scaled(start, scale)
    return Body(
        name=manipulator.name,
        base=manipulator.base,
        chain=chain,
        urdf=urdf.render_for_engine(chain, with_collisions, with_visuals, with_limits),
        start=start,
        drives=tuple(_actuator_torque(entry, chain, scale) for entry in manipulator.actuation),
        loads=tuple(_planned_load(scaled(entry, scale)) for entry in manipulator.loads),
        surfaces=scaled(manipulator.surfaces, scale),
        has_self_collision=manipulator.has_self_collision,
        path=_pose_path(manipulator.motion, start.pose, scale),
        has_engine_limits=with_limits,
        has_zero_torque_motors=with_motors,
    )


def _pose_path(motion: PrescribedMotion | None, start: Pose, scale: Scale) -> PosePath | None:
    return None if motion is None else scaled(motion, scale).path_from(start)


def _planned_object(one: RigidObject, scale: Scale, keeps_unused: bool) -> PlannedObject:
    rigid_object = scaled(one, scale)
    path = _pose_path(one.motion, rigid_object.pose, scale)
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
