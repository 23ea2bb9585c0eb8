"""What a run needs of an engine: a handful of verbs, in engine units."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.engine.contacts import BodyPair, ContactPoint, LinkIndex
from somo_cli.simulation.engine.pressing import ContactReader


class WorldBody(Protocol):
    """What a run needs of one body: joints base to tip, engine units."""

    joint_states: Callable[[], Sequence[Any]]
    """Returns one tuple per joint that starts with its angle and rate."""

    apply: Callable[[Sequence[float]], None]
    """Applies joint torques during the next step."""

    def mass_matrix(self, angles: Sequence[float]) -> Array:
        """Return the joint-space inertia, shape (n, n)."""

    def bias(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        spin: Sequence[float] = (),
        centre: Pose | None = None,
    ) -> Array:
        """Return the forces that gravity and Coriolis terms ask for, on a free base as well.

        With `centre`, the `base_inertial_pose` of a base that can move, that need not be asked for.
        """

    def equivalent_joint_torques(self, forces: Array) -> Array:
        """Return the joint torques that accelerate the joints as these forces do, shape (n,)."""

    def to_base_axes(self, forces: Array) -> Array:
        """Return forces, shape (6 + n,), in the world's axes on the base, in the base's own."""

    def apply_base_wrench(self, wrench: Array, centre: Pose | None = None) -> None:
        """Apply a torque and a force to the base during the next step, in its own axes."""

    def base_inertial_pose(self) -> Pose:
        """Return the pose in the world of the base's centre of mass, along its principal axes."""

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


class WorldObject(Protocol):
    """What a run needs of one object, engine units."""

    principal_moments: Vector
    """The moments of inertia about the principal axes; zeros if nothing can move it."""

    principal_axes: Matrix
    """The principal axes as columns, in the object's frame."""

    def reset(
        self, linear_velocity: Vector | None = None, principal_rate: Vector | None = None
    ) -> None:
        """Put the object at its start, with other velocities if given.

        That of its centre is in the world, the angular one along its principal axes.
        """

    def principal_rate(self) -> Vector:
        """Return the angular velocity [rad/s] along the principal axes."""

    def apply_principal_torque(self, torque: Vector) -> None:
        """Apply a torque, along the principal axes, during the next step."""

    def pose(self) -> Pose:
        """Return the pose of the object's frame in the world."""

    def centre(self) -> Vector:
        """Return the position of its centre of mass in the world."""

    def velocity(self) -> tuple[Vector, Vector]:
        """Return the velocity of its centre and its angular velocity, in the world."""

    def mobility(self) -> tuple[Vector, Array]:
        """Return its centre of mass and the inverse of its inertia, (6, 6), in the world.

        Angular, then linear; zero if it cannot yield.
        """


class WorldFreeBody(WorldBody, Protocol):
    """What a run needs of a body whose base is free."""

    def base_response(self) -> tuple[Array, Array]:
        """Return the inverse M_b⁻¹ of the base's inertia, and M_jb M_b⁻¹, (6, 6) and (n, 6).

        Of the last `mass_matrix`, in the base's own axes: angular, then linear.
        """

    def whole_mass_matrix(self, angles: Sequence[float]) -> Array:
        """Return the inertia of base and joints, shape (6 + n, 6 + n), base first, as above."""

    def inertial_forces(self, angles: Sequence[float], motion: Array, acceleration: Array) -> Array:
        """Return the forces, (6 + n,), with which a body moves so, where there is no gravity.

        All are those of the base first, as above; the linear velocity changes nothing.
        """


class WorldPrescribedBody(WorldBody, Protocol):
    """What a run needs of a body whose base is moved."""

    def move_base(self, goal: Pose, is_at_rest: bool) -> None:
        """Have the base frame at this pose after the next step, and after more if at rest."""

    def base_acceleration_torques(self, acceleration: Array) -> Array:
        """Return the joint torques, shape (n,), that an acceleration of the base asks for.

        Shape (6,), the angular one, then that of the centre of mass, in the world.
        """


class WorldKinematicObject(WorldObject, Protocol):
    """What a run needs of an object that is moved."""

    def move_to(self, goal: Pose, time_step: float) -> None:
        """Have the frame at this pose after the next step."""

    def hold_pose(self) -> None:
        """Have the frame stay where it is until it is moved."""


class World(Protocol):
    """What a run needs of an engine."""

    @property
    def bodies(self) -> Sequence[WorldBody]:
        """The bodies, in the order of the plan."""

    @property
    def objects(self) -> Sequence[WorldObject]:
        """The objects, in the order of the plan."""

    step: Callable[[], object]
    """Advances every body by one time step."""

    def contact_points(self) -> list[ContactPoint]:
        """Return every contact point of the last step, in an order that is always the same."""

    def penetrations(self) -> Sequence[tuple[LinkIndex, LinkIndex, float]]:
        """Return which parts were how deep in each other in the last step; depths above 0 only."""

    def normal_forces(self) -> Mapping[BodyPair, float]:
        """Return the sum of normal forces between each two bodies that pressed in the last step."""

    def contact_reader(self) -> ContactReader:
        """Return what reads the contact points that press."""

    def claim_engine(self) -> None:
        """Set again what all engines of a process share; before steps, if several are open."""

    def adapt_solver_iterations(self) -> None:
        """Let the solver take as many iterations as pay with what `penetrations` saw last."""
