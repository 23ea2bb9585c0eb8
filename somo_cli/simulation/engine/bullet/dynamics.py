"""The dynamics of one body in PyBullet: inertia, bias forces, and their effect on the joints."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.simulation.dynamics.free_base import FreeBase
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.plan.model import Body


class BulletDynamics:
    """A loaded body; joints in the order of its chain, engine units."""

    def __init__(self, engine: BulletClient, index: int, body: Body, gravity: Vector) -> None:
        self.engine = engine
        self.index = index
        self._body = body
        self._gravity = self._gravity_in_base = gravity
        self._is_tilted = False
        self._count = len(body.chain.joints)
        self._coordinate_count = self._count + (0 if body.base == "static" else 6)
        self._pack = struct.Struct(
            f"{self._coordinate_count}d"
        ).pack  # numpy takes longer to read tuples
        self._is_free = body.base == "free"
        self._is_static_upright = False
        self._free_base: FreeBase | None = None  # of the last mass matrix, if nothing holds it
        self._base_coupling: Array = np.zeros((6, self._count))
        self._inverse_dynamics = self._make_inverse_dynamics()
        module, client = engine.module, engine.number
        self._base_pose = partial(module.getBasePositionAndOrientation, index, client)
        self._base_velocity = partial(module.getBaseVelocity, index, client)

    def _update_gravity_in_base(self) -> None:
        """Set the gravity in the axes of the base, from its start pose."""
        axes = geometry.transposed(self.base_inertial_pose().rotation)
        self._gravity_in_base = geometry.rotate(axes, self._gravity)
        difference = geometry.subtract(self._gravity, self._gravity_in_base)
        self._is_tilted = max(map(abs, difference)) > 0
        self._is_static_upright = self._body.base == "static" and not self._is_tilted

    def _make_inverse_dynamics(self) -> Callable[[Sequence[float], Sequence[float]], Array]:
        """Return the engine's function of positions and rates, those of a base that moves first.

        Its forces on a base come first as well, angular, then linear.
        """
        index, client = self.index, self.engine.number
        inverse = self.engine.module.calculateInverseDynamics
        read, pack = np.frombuffer, self._pack
        rest = [0.0] * self._coordinate_count

        def inverse_dynamics(positions: Sequence[float], rates: Sequence[float]) -> Array:
            # seen in 3.2.7: keywords cost a fifth of so short a call; the zero is its flags
            return read(pack(*inverse(index, positions, rates, rest, 0, client)))

        # seen in 3.2.7: forces on the base come out as (linear, angular)
        def with_base(positions: Sequence[float], rates: Sequence[float]) -> Array:
            forces = inverse(index, positions, rates, rest, 0, client)
            return read(pack(*forces[3:6], *forces[:3], *forces[6:]))

        return inverse_dynamics if self._body.base == "static" else with_base

    def mass_matrix(self, angles: Sequence[float]) -> Array:
        """Return the joint-space inertia at these angles, shape (n, n).

        A free base is eliminated: it is what the joints feel when nothing holds the base. A
        constrained base is held within the step.
        """
        matrix = self.whole_mass_matrix(angles)
        if len(matrix) == self._count:
            return matrix
        self._base_coupling = matrix[:6, 6:]
        if self._is_free:
            self._free_base = FreeBase.of(matrix)
            return self._free_base.joint_inertia
        # a product with a contiguous copy takes a third of the time of one with a view
        joints: Array = matrix[6:, 6:].copy()
        return joints

    def whole_mass_matrix(self, angles: Sequence[float]) -> Array:
        """Return the inertia of joints and a base that can move, shape (6 + n, 6 + n).

        The base's rows come first: angular, then linear, in its own axes.
        """
        try:
            rows = self.engine.calculateMassMatrix(self.index, angles)
        except (SystemError, self.engine.error) as error:
            # seen in 3.2.7: it rejects an inertia as asymmetric for differences above 1e-15, which
            # rounding alone causes for more than about 1 engine unit in rotated axes
            raise EngineRefused(
                self._body.name,
                "its inertias are too large for the engine's dynamics; the mass factor of "
                "world_scale changes no result, so choose a smaller one, such as "
                "world_scale: {length: 20, mass: 0.001}",
            ) from error
        pack, size = self._pack, len(rows)
        return np.frombuffer(b"".join([pack(*row) for row in rows])).reshape(size, size)

    def inertial_forces(self, angles: Sequence[float], motion: Array, acceleration: Array) -> Array:
        """Return the forces, (6 + n,), that produce this motion of a free body without gravity.

        Forces, motion and acceleration, (6 + n,), start with those of the base, angular, then
        linear, in its own axes. Its linear velocity has no influence.
        """
        set_gravity, client = self.engine.module.setGravity, self.engine.number
        set_gravity(0.0, 0.0, 0.0, client)
        forces = self.engine.module.calculateInverseDynamics(
            self.index,
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *angles],
            [*motion[:3].tolist(), 0.0, 0.0, 0.0, *motion[6:].tolist()],
            acceleration.tolist(),
            0,
            client,
        )
        set_gravity(*self._gravity, client)
        return np.frombuffer(self._pack(*forces[3:6], *forces[:3], *forces[6:]))

    def bias(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        spin: Sequence[float] = (),
        centre: Pose | None = None,
    ) -> Array:
        """Return the bias forces of gravity and Coriolis terms.

        Shape (n,), the joint torques, with the base at rest; for a free base (6 + n,), with the
        torque and the force on its centre of mass first, in its own axes. `spin` [rad/s] is the
        angular velocity in the world of a base that can move, `centre` its `base_inertial_pose`, if
        that is known already. The gravity is that of the start pose of the base, which makes no
        difference to what the joints of a free body feel.
        """
        if self._is_static_upright:
            return self._inverse_dynamics(angles, rates)
        if not self._is_tilted:
            return self._bias(angles, rates, spin, centre)
        # seen in 3.2.7: inverse dynamics takes the base to stand upright, whatever its pose
        set_gravity, client = self.engine.module.setGravity, self.engine.number
        set_gravity(*self._gravity_in_base, client)
        forces = self._bias(angles, rates, spin, centre)
        set_gravity(*self._gravity, client)
        return forces

    def _bias(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        spin: Sequence[float],
        centre: Pose | None,
    ) -> Array:
        if self._body.base == "static":
            return self._inverse_dynamics(angles, rates)
        # seen in 3.2.7: base rates go in as (angular, linear) in the base's own axes; linear ones
        # change nothing here
        x, y, z = geometry.ZERO
        if spin:
            axes = geometry.transposed((centre or self.base_inertial_pose()).rotation)
            x, y, z = geometry.rotate(axes, (spin[0], spin[1], spin[2]))
        forces = self._inverse_dynamics(
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *angles], [x, y, z, 0.0, 0.0, 0.0, *rates]
        )
        return forces if self._is_free else forces[6:]

    def equivalent_joint_torques(self, forces: Array) -> Array:
        """Return the joint torques, shape (n,), that accelerate the joints as these forces do.

        For a free base the forces, as `bias` gives them, include some on the base.
        """
        if not self._is_free:
            return forces
        assert self._free_base is not None, "the mass matrix comes first"
        return self._free_base.joint_torques(forces)

    def base_response(self) -> tuple[Array, Array]:
        """Return the inverse of the base's inertia, and its product with M_jb, of a free base."""
        assert self._free_base is not None, "the mass matrix comes first"
        return self._free_base.inverse, self._free_base.to_joints

    def to_base_axes(self, forces: Array) -> Array:
        """Return forces as `bias` gives them; those on the base come in the world's axes.

        Shape (6 + n,), of a base that can move.
        """
        axes = np.array(self.base_inertial_pose().rotation)
        own = forces.copy()
        own[:3], own[3:6] = forces[:3] @ axes, forces[3:6] @ axes
        return own

    def base_inertial_pose(self) -> Pose:
        """Return the world pose of the base's centre of mass and principal axes."""
        centre, orientation = self._base_pose()
        return Pose(centre, geometry.rotation_from_quaternion(orientation))
