"""The plan of a run: all that is decided before any engine starts, in the engine's units."""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.dimensions import (
    Acceleration,
    Angle,
    AngularRate,
    Length,
    Scale,
    Velocity,
)
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.columns import Recorded
from somo_cli.scene.compound import Compound
from somo_cli.scene.contact_surface import ContactSurface, Ground, ManipulatorSurfaces
from somo_cli.scene.model import (
    Base,
    Frame,
    Integrator,
    Quantity,
)
from somo_cli.scene.prescribed_motion import PosePath
from somo_cli.scene.rigid_object import ObjectQuantity, RigidObject
from somo_cli.scene.signals import PiecewiseSignal, Signal
from somo_cli.scene.stop_conditions import StopCondition

EQUAL_MOMENTS = 1e-9
"""Relative difference up to which moments of inertia count as equal: it is rounding."""


@dataclass(frozen=True, slots=True)
class ActuatorTorque:
    """A torque over time, and the joints of one body that it acts on.

    `signal` is in engine units. `si_signal` [N·m] is recorded, because no scaling has rounded it.
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
    """Pose and velocity of the base frame in the world, and joint state, at time zero.

    Engine units; angles and rates of the joints have shape (n,).
    """

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
    """A manipulator to load: its `chain` in engine units, and its URDF.

    Where nothing can touch, the URDF has no shapes. They would cost the engine time and change
    nothing, since the file gives every inertia.
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
    """The pose of the base over time, None without prescribed motion."""
    has_engine_limits: bool = True
    """Whether the engine has the joint limits; the integrator always has them."""
    has_zero_torque_motors: bool = False
    """Whether joints without dry friction have a solver row too, which has no effect."""

    @property
    def has_moving_base(self) -> bool:
        """Whether the base is free, or has a prescribed motion."""
        return self.base == "free" or self.path is not None


@dataclass(frozen=True, slots=True)
class PlannedObject:
    """An object to load, in engine units: its URDF or compound, and its prescribed path if any."""

    rigid_object: RigidObject
    urdf: str
    compound: Compound | None = None
    path: PosePath | None = None

    @property
    def has_gyroscopic_torque(self) -> bool:
        """Whether it can rotate freely and its moments of inertia differ by more than rounding."""
        if self.rigid_object.has_prescribed_pose:
            return False
        least, _, most = geometry.principal_moments(
            self.rigid_object.chain.links[0].inertial.inertia
        )
        return most - least > EQUAL_MOMENTS * most


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
    """Whether a body has anything within reach that it could touch, itself included."""
    only: tuple[str, ...] = ()
    stop_conditions: tuple[StopCondition, ...] = ()
    records_last_step: bool = False
    """Whether the last step is always recorded, as it is where a condition may stop the run."""
    keeps_unused: bool = False
    """Whether the engine loads shapes, solves rows and reads state that no result needs."""

    @property
    def recorded(self) -> Recorded:
        """The recorded quantities and the names that the columns depend on."""
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
