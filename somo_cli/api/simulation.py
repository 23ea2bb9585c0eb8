"""A simulation that is stepped by its user: feedback control, learning, notebooks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import TracebackType

import numpy as np

from somo_cli import loading
from somo_cli.api.documents import Source, document_of
from somo_cli.arrays import Array
from somo_cli.loading import Auto
from somo_cli.manipulator import geometry
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.model import without_recording
from somo_cli.simulation.dynamics.forward_kinematics import (
    ForwardKinematics,
    frames_from_poses,
    point_positions,
)
from somo_cli.simulation.engine import contacts
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.integrator.body_stepper import BodyStepper
from somo_cli.simulation.monitoring.findings import Finding
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.units import unit_factors_of
from somo_cli.simulation.session import Session


class Simulation:
    """A scene in its own engine, which `step` advances.

    All values are in SI units and at the present time; positions and forces are in the world frame.
    Divergence is monitored as in a run. The recording and the stop conditions of the scene are
    ignored. Close the simulation, or use it in a `with` statement. Several simulations do not
    disturb each other.

    `source` is a loaded scene or definition, or the path of one; `time_step` ([s], or "auto")
    replaces that of the scene.

    Raises:
        InvalidFile: The scene has errors, or bodies of it overlap at the start.
        EngineMissing, EngineRefused: There is no engine, or it cannot load a body.
        OSError: A file cannot be read.
    """

    def __init__(self, source: Source, *, time_step: float | Auto | None = None) -> None:
        document = document_of(source)
        scene, _ = loading.scene_of(document, None, time_step)
        loading.refuse_overlaps(document, scene)
        self._plan = make_plan(without_recording(scene))
        self._units = unit_factors_of(self._plan)
        self._numbers = {name: number for number, name in enumerate(self._plan.recorded.names[:-1])}
        self._poses = [ForwardKinematics(body.chain) for body in self._plan.bodies]
        self._world: BulletWorld | None = None
        self._open()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the engine; the simulation cannot be used any more."""
        world, self._world = self._world, None
        if world is not None:
            world.close()

    @property
    def time(self) -> float:
        """The present time [s]; 0 at the start."""
        return self._session.time

    @property
    def time_step(self) -> float:
        """The time step [s]."""
        return self._plan.time_step

    @property
    def manipulators(self) -> tuple[str, ...]:
        """The names of the manipulators, in the order of the scene."""
        return tuple(body.name for body in self._plan.bodies)

    @property
    def objects(self) -> tuple[str, ...]:
        """The names of the objects, in the order of the scene."""
        return self._plan.recorded.objects

    def step(self, steps: int = 1) -> None:
        """Advance by `steps` time steps; the trajectory does not depend on how calls divide them.

        Raises SimulationDiverged, at most eight steps after the divergence.
        """
        if steps < 0:
            raise ValueError(f"steps is {steps}, but must not be negative")
        session = self._require_open()
        last = session.step + steps
        with np.errstate(over="ignore", invalid="ignore"):  # divergence is monitored
            session.world.claim_engine()
            while session.step < last:
                session.actuate()
                session.monitor()
                session.advance(session.schedule.pause_after(session.step, last))

    def reset(self) -> None:
        """Go back to the start without loading the scene again, and discard torques that were set.

        The trajectory from there is exactly the same again.
        """
        self._require_open()
        assert self._world is not None
        if self._plan.can_touch:
            # the engine caches past contacts, and the state that it saves does not include them
            self._world.close()
            self._open()
        else:
            self._world.restore_start()
            self._session = Session(self._plan, self._world)

    def angles(self, manipulator: str) -> Array:
        """Return the joint angles of a manipulator, base to tip [rad], shape (n,)."""
        return self._stepper(manipulator).law.angles.copy()

    def rates(self, manipulator: str) -> Array:
        """Return the joint rates of a manipulator, base to tip [rad/s], shape (n,).

        The implicit integrator has rates half a time step earlier; they are extrapolated to the
        present time with the acceleration of the last step.
        """
        stepper = self._stepper(manipulator)
        if self._session.step == 0:
            return np.array(stepper.body.start.rates)
        return stepper.rates_of_instant()

    def tip_position(self, manipulator: str, limb: int = 0) -> Array:
        """Return the tip position of a manipulator, or of a limb of an assembly [m], shape (3,)."""
        stepper = self._stepper(manipulator)
        number, chain = self._numbers[manipulator], stepper.body.chain
        frames = self._poses[number].frames(
            stepper.law.angles[:, np.newaxis], frames_from_poses([stepper.world_body.base_pose()])
        )
        ends = [(one.last_link, one.tip) for one in chain.limbs] or [(-1, chain.tip)]
        link, tip = ends[limb]
        return np.asarray(point_positions(frames, link, tip)[:, 0] / self._units.length)

    def base_pose(self, manipulator: str) -> tuple[Array, Array]:
        """Return position [m], shape (3,), and quaternion (x, y, z, w) of a manipulator's base."""
        return self._si_pose(self._stepper(manipulator).world_body.base_pose())

    def object_pose(self, name: str) -> tuple[Array, Array]:
        """Return position [m], shape (3,), and quaternion (x, y, z, w) of an object's frame."""
        return self._si_pose(self._require_open().world.objects[self._object(name)].pose())

    def object_velocity(self, name: str) -> tuple[Array, Array]:
        """Return velocity of the centre of mass [m/s] and angular velocity [rad/s], shapes (3,).

        With the implicit integrator they are those of half a time step earlier.
        """
        linear, spin = self._require_open().world.objects[self._object(name)].velocity()
        return np.array(linear) / self._units.length, np.array(spin)

    def contact_force(self, name: str) -> Array:
        """Return the contact force on a manipulator or object in the last step [N], shape (3,)."""
        session = self._require_open()
        if name not in self._numbers:
            raise KeyError(self._unknown(name, self._numbers))
        if session.step == 0:
            return np.zeros(3)
        touching = contacts.contacts_on(session.world.contact_points(), self._numbers[name])
        return np.array(contacts.total_force(touching)[:3]) / self._units.force

    def findings(self) -> tuple[Finding, ...]:
        """Return what was found so far of contact that no rigid body does, in order of time."""
        return self._require_open().findings()

    def set_torque(self, manipulator: str, *, actuator: int, axis: int, torque: float) -> None:
        """Apply a torque [N·m] to each joint of an actuator and axis, from now on.

        It replaces the actuation of the scene on that axis until the next call or `reset`. Raises
        KeyError for an unknown manipulator, and ValueError for an axis without joints or a torque
        that is not finite.
        """
        stepper = self._stepper(manipulator)
        if not math.isfinite(torque):
            raise ValueError(f"the torque is {torque}, but must be a finite number")
        channels = [(joint.actuator, joint.channel) for joint in stepper.body.chain.joints]
        joints = tuple(index for index, one in enumerate(channels) if one == (actuator, axis))
        if not joints:
            known = ", ".join(f"({first}, {second})" for first, second in sorted(set(channels)))
            raise ValueError(
                f"'{manipulator}' has no joints of actuator {actuator} about axis {axis}; "
                f"it has (actuator, axis) {known}"
            )
        stepper.actuation.give_torque(joints, torque, self._units.torque)
        self._session.note_drive()

    def _open(self) -> None:
        world = BulletWorld(self._plan)
        world.__enter__()
        self._world = world
        if not self._plan.can_touch:
            world.save_start()
        self._session = Session(self._plan, world)

    def _require_open(self) -> Session:
        if self._world is None:
            raise RuntimeError("the simulation is closed")
        return self._session

    def _stepper(self, manipulator: str) -> BodyStepper:
        session = self._require_open()
        bodies = [body.name for body in self._plan.bodies]
        if manipulator not in bodies:
            raise KeyError(self._unknown(manipulator, dict.fromkeys(bodies, 0)))
        return session.steppers[bodies.index(manipulator)]

    def _object(self, name: str) -> int:
        objects = self._plan.recorded.objects
        if name not in objects:
            raise KeyError(self._unknown(name, dict.fromkeys(objects, 0)))
        return objects.index(name)

    def _si_pose(self, pose: Pose) -> tuple[Array, Array]:
        position = np.array(pose.position) / self._units.length
        return position, np.array(geometry.quaternion_from_rotation(pose.rotation))

    @staticmethod
    def _unknown(name: str, known: Mapping[str, int]) -> str:
        names = f"the names are {', '.join(known)}" if known else "it has no such names at all"
        return f"the scene has no '{name}'; {names}"
