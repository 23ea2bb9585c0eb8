"""The scene as a person describes it, in SI; `reader` makes it from a document."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Literal, get_args

from somo_cli.document.parse import Document
from somo_cli.manipulator.assembly import is_assembly
from somo_cli.manipulator.compile import FILE_POINTERS as DEFINITION_FILE_POINTERS
from somo_cli.manipulator.compile import Compiled
from somo_cli.manipulator.dimensions import Force, Number, Position, Scale, Time, Torque
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import Pointer
from somo_cli.scene.actuation import Actuation
from somo_cli.scene.contact_surface import Ground, ManipulatorSurfaces
from somo_cli.scene.prescribed_motion import PrescribedMotion
from somo_cli.scene.rigid_object import ObjectQuantity, RigidObject
from somo_cli.scene.signals import Interpolation
from somo_cli.scene.stop_conditions import StopCondition

Integrator = Literal["implicit", "euler", "explicit"]
Base = Literal["static", "free", "constrained"]
Frame = Literal["world", "body"]
Quantity = Literal[
    "joint_angles",
    "joint_rates",
    "spring_torques",
    "actuation",
    "link_positions",
    "link_orientations",
    "base_pose",
    "tip_position",
    "tip_velocity",
    "tip_orientation",
    "curvatures",
    "bending_angles",
    "energy",
    "contact_force",
    "contact_pairs",
    "link_contact_forces",
]

ClosedForm = Literal[
    "pendulum",
    "damped_oscillator",
    "cantilever_tip_load",
    "elastica",
    "end_moment",
    "own_weight",
]

DEFAULT_TIME_STEP = 1e-3  # s
AUTOMATIC_TIME_STEP = "auto"
"""In place of a time step: the one that `somo check --numerics` recommends."""
NEUTRAL = "neutral"
"""In place of initial angles: those at which all springs are relaxed."""
DEFAULT_GRAVITY = (0.0, 0.0, -9.81)  # m/s²
DEFAULT_QUANTITIES: tuple[Quantity, ...] = ("joint_angles", "tip_position")
ALL_QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
ALL_OBJECT_QUANTITIES: tuple[ObjectQuantity, ...] = get_args(ObjectQuantity)

FILE_POINTERS: tuple[tuple[str, ...], ...] = (
    ("manipulators", "*", "definition"),
    *(("manipulators", "*", "definition", *place) for place in DEFINITION_FILE_POINTERS),
    ("trajectories", "*", "sorotraj"),
)
"""Where a scene may name a file instead of holding a mapping."""


@dataclass(frozen=True, slots=True)
class ExternalLoad:
    """A force and a moment on one link, 0 the base, times a factor over time.

    `point`, where the force acts, is in the link's frame. Force and moment are in the world's axes
    or, if `frame` is "body", in those of the link, with which they turn.
    """

    link: int
    point: Position
    force: tuple[Force, Force, Force]
    moment: tuple[Torque, Torque, Torque]
    frame: Frame
    waypoints: tuple[tuple[Time, Number], ...]
    interpolation: Interpolation
    repeat: bool


@dataclass(frozen=True, slots=True)
class Manipulator:
    """A compiled definition, where it stands [m, rad], how it starts [rad/s, m/s], what acts on it.

    Position and velocities are those of the base frame's origin, in the world frame.
    """

    name: str
    compiled: Compiled
    position: Vector
    rpy: Vector
    base: Base
    initial_angles: tuple[float, ...]
    initial_rates: tuple[float, ...]
    linear_velocity: Vector
    angular_velocity: Vector
    actuation: tuple[Actuation, ...]
    loads: tuple[ExternalLoad, ...]
    surfaces: ManipulatorSurfaces
    has_self_collision: bool = False
    motion: PrescribedMotion | None = None

    @property
    def pose(self) -> Pose:
        """The pose of its base frame in the world, at the start."""
        return Pose.of(self.position, self.rpy)


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything a run needs but the number of steps; SI throughout.

    `columns` and `object_quantities` are recorded of manipulators and objects, but only columns
    that match one of the patterns `only`, if there are any. `stop_conditions` end a run early.
    `duration` is the simulated time [s] unless a command says another.
    `reference` is the closed form that a study compares the results with, if there is one.
    `is_time_step_automatic` says that the scene leaves the time step to us; `expected_tip_error` is
    the error of the tip, relative to the length, for which it was chosen.
    """

    time_step: float
    gravity: Vector
    integrator: Integrator
    scale: Scale
    manipulators: tuple[Manipulator, ...]
    every: int
    columns: tuple[Quantity, ...]
    reference: ClosedForm | None
    ground: Ground | None
    objects: tuple[RigidObject, ...]
    object_quantities: tuple[ObjectQuantity, ...]
    only: tuple[str, ...] = ()
    stop_conditions: tuple[StopCondition, ...] = ()
    has_contact_events: bool = False
    is_time_step_automatic: bool = False
    duration: float | None = None
    expected_tip_error: float | None = None


# without duration, which a study has as well
_KEYS_OF_SCENES = {
    *("time_step", "gravity", "integrator", "record", "reference"),
    *("ground", "objects", "stop"),
}


def is_scene(document: Document) -> bool:
    """Tell a scene from a definition, of a manipulator or an assembly, by its keys."""
    keys = set(document.data) if isinstance(document.data, dict) else set()
    if "manipulators" in keys or is_assembly(document.data):
        return "manipulators" in keys
    if keys & {"manipulator_name", "actuator_definitions"}:
        return False
    return not keys.isdisjoint(_KEYS_OF_SCENES)


def single_manipulator_scene(definition: Document) -> Document:
    """Return the scene of one manipulator alone: fixed, under gravity, everything default."""
    # the scene has the position of the definition, so that every problem has a position
    place: Pointer = ("manipulators", 0, "definition")
    spans = {(*place, *pointer): pair for pointer, pair in definition.spans.items()}
    spans |= {place[:length]: definition.spans[()] for length in range(len(place))}
    data = {"manipulators": [{"definition": definition.data}]}
    return Document(definition.source, data, definition.texts, spans)


def without_recording(scene: Scene) -> Scene:
    """Return the scene without recording and stop conditions, for users who read the state."""
    return dataclasses.replace(
        scene,
        columns=(),
        object_quantities=(),
        only=(),
        stop_conditions=(),
        has_contact_events=False,
    )
