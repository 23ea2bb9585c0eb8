"""The interface of an engine: all that a run asks of one, in engine units."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Matrix, Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.engine.contacts import BodyPair, ContactPoint, LinkIndex
from somo_cli.simulation.engine.pressing import ContactReader


class WorldBody(Protocol):
    """A manipulator in an engine: joints from base to tip, engine units."""

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
        """Return the bias forces of gravity and Coriolis terms, those on a free base included.

        `centre` is the `base_inertial_pose` of a base that can move, if it is known already.
        """

    def equivalent_joint_torques(self, forces: Array) -> Array:
        """Return the joint torques that accelerate the joints as these forces do, shape (n,)."""

    def to_base_axes(self, forces: Array) -> Array:
        """Return forces, shape (6 + n,), with those on the base turned from world to base axes."""

    def apply_base_wrench(self, wrench: Array, centre: Pose | None = None) -> None:
        """Apply a torque and a force to the base during the next step, in its own axes."""

    def base_inertial_pose(self) -> Pose:
        """Return the world pose of the base's centre of mass and principal axes."""

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
    """An object in an engine, engine units."""

    principal_moments: Vector
    """The moments of inertia about the principal axes; zeros if nothing can move it."""

    principal_axes: Matrix
    """The principal axes as columns, in the object's frame."""

    def reset(
        self, linear_velocity: Vector | None = None, principal_rate: Vector | None = None
    ) -> None:
        """Put the object at its start, with these velocities if they are given.

        The velocity of its centre is in the world, the angular velocity along its principal axes.
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

        Angular coordinates first, then linear; zero if it cannot move.
        """


class WorldFreeBody(WorldBody, Protocol):
    """A manipulator with a free base."""

    def base_response(self) -> tuple[Array, Array]:
        """Return the inverse M_b⁻¹ of the base's inertia, and M_jb M_b⁻¹, (6, 6) and (n, 6).

        Of the last `mass_matrix`, in the base's own axes: angular, then linear.
        """

    def whole_mass_matrix(self, angles: Sequence[float]) -> Array:
        """Return the inertia of base and joints, shape (6 + n, 6 + n), base first, as above."""

    def inertial_forces(self, angles: Sequence[float], motion: Array, acceleration: Array) -> Array:
        """Return the forces, (6 + n,), that produce this motion without gravity.

        The base comes first, as above. Its linear velocity has no influence.
        """


class WorldPrescribedBody(WorldBody, Protocol):
    """A manipulator whose base has a prescribed motion."""

    def move_base(self, goal: Pose, is_at_rest: bool) -> None:
        """Move the base frame to this pose in the next step; hold it there if it is at rest."""

    def base_acceleration_torques(self, acceleration: Array) -> Array:
        """Return the joint torques, shape (n,), that an acceleration of the base requires.

        The acceleration, shape (6,), is in the world: angular, then that of the centre of mass.
        """


class WorldKinematicObject(WorldObject, Protocol):
    """An object with a prescribed motion."""

    def move_to(self, goal: Pose, time_step: float) -> None:
        """Move the frame to this pose in the next step."""

    def hold_pose(self) -> None:
        """Hold the frame at its present pose until the next `move_to`."""


class World(Protocol):
    """An engine with everything that a plan has loaded into it."""

    @property
    def bodies(self) -> Sequence[WorldBody]:
        """The bodies, in the order of the plan."""

    @property
    def objects(self) -> Sequence[WorldObject]:
        """The objects, in the order of the plan."""

    step: Callable[[], object]
    """Advances every body by one time step."""

    def contact_points(self) -> list[ContactPoint]:
        """Return all contact points of the last step, in a reproducible order."""

    def penetrations(self) -> Sequence[tuple[LinkIndex, LinkIndex, float]]:
        """Return each pair of links that overlapped in the last step, and its depth, above 0."""

    def normal_forces(self) -> Mapping[BodyPair, float]:
        """Return the sum of normal forces of each pair of bodies that pressed in the last step."""

    def contact_reader(self) -> ContactReader:
        """Return the reader of the contact points that press."""

    def claim_engine(self) -> None:
        """Set the parameters that all engines of a process share, in case another changed them."""

    def adapt_solver_iterations(self) -> None:
        """Choose the solver's iterations for the contacts that `penetrations` saw last."""
