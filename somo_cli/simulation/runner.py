"""One body in motion: its law, its actuation, its energy, and how it starts."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.plan import Body, Plan
from somo_cli.simulation.springs import Array, SpringLaw, Springs
from somo_cli.simulation.watch import BodyEnergy

REFRESH_ANGLE = 0.015  # rad, root of the sum of squares over the joints since the last refresh
SWIFT_ANGLE = 0.0025  # rad per step; a slower body makes do with Coriolis forces a few steps old
STEPS_BETWEEN_LOOKS = 8


class WorldBody(Protocol):
    """What a run needs of one body: joints base to tip, engine units."""

    joint_states: Callable[[], Sequence[Any]]
    """Returns one tuple per joint that starts with its angle and rate."""

    def apply(self, torques: Sequence[float]) -> None:
        """Apply joint torques during the next step."""

    def mass_matrix(self, angles: Sequence[float]) -> Array:
        """Return the joint-space inertia, shape (n, n)."""

    def bias(self, angles: Sequence[float], rates: Sequence[float]) -> Array:
        """Return the joint torques that gravity and Coriolis forces ask for, shape (n,)."""

    def base_pose(self) -> Pose:
        """Return the pose of the base frame in the world."""

    def base_velocity(self) -> tuple[Vector, Vector]:
        """Return the velocity of the base's centre of mass, and its angular velocity."""

    def reset(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        """Go to the start pose with these angles and rates."""


class World(Protocol):
    """What a run needs of an engine."""

    @property
    def bodies(self) -> Sequence[WorldBody]:
        """The bodies, in the order of the plan."""

    step: Callable[[], object]
    """Advances every body by one time step."""


class Runner:
    """One body in motion; most steps are a `push` and a `pull`."""

    def __init__(self, plan: Plan, body: Body, world_body: WorldBody) -> None:
        joints = body.chain.joints
        springs = Springs(
            np.array([joint.stiffness for joint in joints]),
            np.array([joint.damping for joint in joints]),
            np.array([joint.neutral_position for joint in joints]),
        )
        self.body = body
        self.world_body = world_body
        self.law = SpringLaw(springs, plan.time_step, plan.integrator)
        self.energy = BodyEnergy(body, springs, plan.gravity)
        self.mass: Array = np.zeros((0, 0))
        self.torques: Array = np.zeros(len(joints))
        self.is_steady = all(drive.signal.is_constant for drive in body.drives)
        self._mass_angles: Array = np.zeros(0)
        self._is_swift = False
        self._drives = [(drive.signal, list(drive.joints)) for drive in body.drives]
        self.pull = self._make_pull()
        self.actuate(0.0)

    def actuate(self, time: float) -> None:
        """Set the actuation torques of a time [s]."""
        for signal, joints in self._drives:
            self.torques[joints] = signal.at(time)
        self.law.actuation = self.torques

    def push(self) -> None:
        """Apply the torques of the law to the world."""
        if self._is_swift:
            self.refresh_if_moved()
            self.push_corrected()
        else:
            self.world_body.apply(self.law.advance())

    def push_corrected(self) -> None:
        """Apply the torques of the law, corrected for the engine's early Coriolis forces."""
        if self.law.integrator == "explicit":
            self.world_body.apply(self.law.advance())
            return
        angles, bias = self.law.angles.tolist(), self.world_body.bias
        torques = self.law.advance_corrected(lambda rates: bias(angles, rates.tolist()))
        self.world_body.apply(torques)

    def _make_pull(self) -> Callable[[], None]:
        """Return the function that reads angles and rates from the world, its names bound."""
        joint_states, state = self.world_body.joint_states, self.law.state
        pack = struct.Struct(f"{2 * len(self.torques)}d").pack_into

        def pull() -> None:
            angles, rates, _, _ = zip(*joint_states(), strict=False)
            pack(state, 0, *angles, *rates)

        return pull

    def look(self) -> None:
        """Renew the mass matrix if it is too old, and see how fast the body moves."""
        self.refresh_if_moved()
        fastest = float(np.abs(self.law.rates).max())
        self._is_swift = fastest * self.law.time_step > SWIFT_ANGLE

    def refresh_if_moved(self) -> None:
        """Renew the mass matrix if it is that of angles too far from the present ones."""
        moved = self.law.angles - self._mass_angles
        if moved.dot(moved) > REFRESH_ANGLE**2:
            self.refresh()

    def refresh(self) -> None:
        """Renew the mass matrix for the present angles."""
        self._mass_angles = self.law.angles.copy()
        self.mass = self.world_body.mass_matrix(self._mass_angles.tolist())
        self.law.refresh(self.mass)

    def measure_energy(self) -> tuple[float, float]:
        """Return the energy of the body and the most it may be."""
        law = self.law
        energy, bound = self.energy.update(law.angles, law.rates, self.torques, self.mass)
        if self.body.base == "free":
            start = self.body.start.position
            moved = geometry.subtract(self.world_body.base_pose().position, start)
            bound += self.energy.fall_of_base(geometry.norm(moved))
        return energy, bound

    def go_to_start(
        self,
        rates: Sequence[float] | None = None,
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        """Put the body back to its start, with other velocities if given."""
        start = self.body.start
        self.world_body.reset(start.angles, rates or start.rates, base_velocity)
        self.pull()


def begin(plan: Plan, world: World, runners: Sequence[Runner]) -> None:
    """Bring every body to its start, with the velocities its integrator wants there.

    The forces that are not ours at the start are measured by a step without torques, which is
    then undone. For the implicit law velocities live at half steps, so the bodies start with
    v0 - h/2 a0; how the bases accelerate under the first torques is measured by a second step.
    """
    for runner in runners:
        runner.pull()
        runner.refresh()
    if plan.integrator == "explicit":
        return
    bases = [runner.world_body.base_velocity() for runner in runners]
    rates = [runner.law.rates.copy() for runner in runners]
    forces = []
    for runner in runners:
        runner.world_body.apply([0.0] * len(runner.torques))
    world.step()
    for runner, before in zip(runners, rates, strict=True):
        runner.pull()
        forces.append(runner.mass @ (runner.law.rates - before) / plan.time_step)
        runner.go_to_start()
    if plan.integrator == "implicit":
        _step_back_half(plan, world, runners, forces, bases)
    for runner, force, before in zip(runners, forces, rates, strict=True):
        angles = runner.law.angles.tolist()
        runner.law.measure(force, runner.world_body.bias(angles, before.tolist()))


def _step_back_half(
    plan: Plan,
    world: World,
    runners: Sequence[Runner],
    forces: Sequence[Array],
    bases: Sequence[tuple[Vector, Vector]],
) -> None:
    accelerations = []
    for runner, force in zip(runners, forces, strict=True):
        acceleration = runner.law.acceleration(runner.mass, force)
        torques = runner.mass @ acceleration - force
        runner.world_body.apply(torques.tolist())
        accelerations.append(acceleration)
    world.step()
    for runner, acceleration, base in zip(runners, accelerations, bases, strict=True):
        after = runner.world_body.base_velocity()
        linear, angular = (
            _half_a_step_earlier(before, now) for before, now in zip(base, after, strict=True)
        )
        rates = np.array(runner.body.start.rates) - 0.5 * plan.time_step * acceleration
        runner.go_to_start(rates.tolist(), (linear, angular))


def _half_a_step_earlier(before: Vector, after: Vector) -> Vector:
    return (
        1.5 * before[0] - 0.5 * after[0],
        1.5 * before[1] - 0.5 * after[1],
        1.5 * before[2] - 0.5 * after[2],
    )
