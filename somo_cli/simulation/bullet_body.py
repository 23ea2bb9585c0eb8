"""One body in PyBullet: loading, releasing and reading it back, its motion and its dynamics.

The engine's module is handed in by `bullet`, which alone imports it.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.simulation.bullet_self import spare_near_links
from somo_cli.simulation.bullet_surface import settings
from somo_cli.simulation.plan import Body
from somo_cli.simulation.readback import EngineJoint, EngineLink, mismatches
from somo_cli.simulation.springs import Array, invert

MANY_JOINTS = 40  # for more of them it takes longer to read numbers for nothing than names
UNLIMITED_RATE = 1e12  # rad/s; the engine's own clamp of 100 hides divergence
# engine units; seen in 3.2.7: any motor has its row whose force times the time step is not 0, and
# one of this force changes no rate but one that is exactly 0, to less than 1e-290 or so
IDLE_TORQUE = 1e-300


class BulletBody:
    """One manipulator in the engine; joints in the order of its chain, engine units."""

    def __init__(self, bullet: Any, client: int, body: Body, gravity: Vector, path: str) -> None:
        self._bullet = bullet
        self._client = client
        self._body = body
        self._gravity = gravity
        # the inertia must come from the file, or the engine computes
        # its own from the collision shapes
        flags = bullet.URDF_USE_INERTIA_FROM_FILE | bullet.URDF_USE_IMPLICIT_CYLINDER
        if body.collides_with_itself:
            flags |= bullet.URDF_USE_SELF_COLLISION
        self.index: int = bullet.loadURDF(
            path,
            useFixedBase=body.base == "static",
            flags=flags,
            physicsClientId=client,
        )
        self._joints = self._joint_indices()
        self._freedoms = len(self._joints) + (0 if body.base == "static" else 6)
        self._pack = struct.Struct(f"{self._freedoms}d").pack  # numpy takes longer to read tuples
        self._is_free = body.base == "free"
        self._base_to_joints: Array = np.zeros((len(self._joints), 6))
        self._across: Array = self._base_to_joints.T
        # bound once, without a Python frame of ours between loop and engine: one tuple per joint,
        # base to tip, that starts with angle and rate
        self.joint_states: Callable[[], Any] = partial(
            bullet.getJointStates, self.index, self._joints, client
        )
        self.apply = self._make_apply()
        self._inverse_dynamics = self._make_inverse_dynamics()
        self._read_back()
        self._release()
        if body.collides_with_itself:
            spare_near_links(bullet, client, self.index, self.links, body.chain)
        self._com_in_base, self._inertial_in_base = self._base_inertial_frame()
        self.reset(body.start.angles, body.start.rates)
        axes = geometry.transposed(self.centre_pose().rotation)
        self._gravity_in_base = geometry.rotate(axes, gravity)
        self._is_tilted = max(map(abs, geometry.subtract(gravity, self._gravity_in_base))) > 0
        self._is_plain = body.base == "static" and not self._is_tilted
        if body.base == "constrained":
            self._hold_base()

    def _make_apply(self) -> Callable[[Sequence[float]], None]:
        """Return the function that applies joint torques, base to tip, during the next step."""
        index, joints, client = self.index, self._joints, self._client
        control, mode = self._bullet.setJointMotorControlArray, self._bullet.TORQUE_CONTROL

        # seen in 3.2.7: names cost a quarter of the call for ten joints; without them there must be
        # positions, rates and gains, which are read and, in this mode, used for nothing
        def apply(torques: Sequence[float]) -> None:
            control(index, joints, mode, torques, torques, torques, torques, torques, client)

        def apply_to_many(torques: Sequence[float]) -> None:
            control(index, joints, mode, forces=torques, physicsClientId=client)

        return apply if len(joints) <= MANY_JOINTS else apply_to_many

    def _make_inverse_dynamics(self) -> Callable[[Sequence[float], Sequence[float]], Array]:
        """Return the engine's function of positions and rates, those of a base that moves first.

        Its forces on a base come first as well, angular, then linear.
        """
        index, client = self.index, self._client
        inverse, read, pack = self._bullet.calculateInverseDynamics, np.frombuffer, self._pack
        rest = [0.0] * self._freedoms

        def inverse_dynamics(positions: Sequence[float], rates: Sequence[float]) -> Array:
            # seen in 3.2.7: names cost a fifth of a call that short; the zero is for its flags
            return read(pack(*inverse(index, positions, rates, rest, 0, client)))

        # seen in 3.2.7: forces on the base come out as (linear, angular)
        def with_base(positions: Sequence[float], rates: Sequence[float]) -> Array:
            told = inverse(index, positions, rates, rest, 0, client)
            return read(pack(*told[3:6], *told[:3], *told[6:]))

        return inverse_dynamics if self._body.base == "static" else with_base

    @property
    def links(self) -> tuple[int, ...]:
        """The engine's numbers of the links, base to tip."""
        return (-1, *self._joints)

    def mass_matrix(self, angles: Sequence[float]) -> Array:
        """Return the joint-space inertia at these angles, shape (n, n).

        For a free base it is the Schur complement in which the base is eliminated: what the
        joints feel when nothing holds the base. A constrained base is held within the step.
        """
        # the base's rows, if it can move, come first: angular, then linear, in its own frame
        try:
            rows = self._bullet.calculateMassMatrix(
                self.index, angles, physicsClientId=self._client
            )
        except (SystemError, self._bullet.error) as error:
            # seen in 3.2.7: it takes rounding of more than 1e-15 for an inertia that is not
            # symmetric, so one of more than about 1 engine unit, in turned axes, is refused
            raise EngineRefused(
                self._body.name,
                "its inertias are too large for the engine's dynamics; the mass factor of "
                "world_scale changes no result, so choose a smaller one, such as "
                "world_scale: {length: 20, mass: 0.001}",
            ) from error
        pack, size = self._pack, len(rows)
        matrix: Array = np.frombuffer(b"".join([pack(*row) for row in rows])).reshape(size, size)
        if size == len(self._joints):
            return matrix
        # products with an array of its own take a third of those with a part of another
        base, across, joints = matrix[:6, :6], matrix[:6, 6:], matrix[6:, 6:].copy()
        self._across = across
        if not self._is_free:
            return joints
        self._base_to_joints = across.T.dot(invert(base))
        reduced: Array = joints - self._base_to_joints.dot(across)
        return (reduced + reduced.T) / 2

    def bias(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        spin: Sequence[float] = (),
        centre: Pose | None = None,
    ) -> Array:
        """Return the forces that gravity and Coriolis terms ask for.

        Shape (n,), the joint torques, with the base at rest; for a free base (6 + n,), with the
        torque and the force on its centre of mass first, in its own axes. `spin` [rad/s] is the
        angular velocity in the world of a base that can move, `centre` its `centre_pose`, for who
        has asked already. The gravity is that of the start pose of the base, which makes no
        difference to what the joints of a free body feel.
        """
        if self._is_plain:
            return self._inverse_dynamics(angles, rates)
        if not self._is_tilted:
            return self._bias(angles, rates, spin, centre)
        # seen in 3.2.7: inverse dynamics takes the base to stand upright, whatever its pose
        set_gravity = self._bullet.setGravity
        set_gravity(*self._gravity_in_base, self._client)
        forces = self._bias(angles, rates, spin, centre)
        set_gravity(*self._gravity, self._client)
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
            axes = geometry.transposed((centre or self.centre_pose()).rotation)
            x, y, z = geometry.rotate(axes, (spin[0], spin[1], spin[2]))
        forces = self._inverse_dynamics(
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *angles], [x, y, z, 0.0, 0.0, 0.0, *rates]
        )
        return forces if self._is_free else forces[6:]

    def felt_by_joints(self, forces: Array) -> Array:
        """Return the joint torques, shape (n,), that accelerate the joints as these forces do.

        For a free base the forces, as `bias` gives them, include some on the base.
        """
        if not self._is_free:
            return forces
        felt: Array = forces[6:] - self._base_to_joints.dot(forces[:6])
        return felt

    def in_base_axes(self, forces: Array) -> Array:
        """Return forces as `bias` gives them; those on the base come in the world's axes.

        Shape (6 + n,), of a base that can move.
        """
        axes = np.array(self.centre_pose().rotation)
        own = forces.copy()
        own[:3], own[3:6] = forces[:3] @ axes, forces[3:6] @ axes
        return own

    def push_base(self, wrench: Array, centre: Pose | None = None) -> None:
        """Apply a torque and a force, shape (6,), to the base's centre of mass in the next step.

        In the base's own axes, as `bias` gives them; `centre` is as there.
        """
        at = centre or self.centre_pose()
        tx, ty, tz, fx, fy, fz = wrench.tolist()
        torque, force = (geometry.rotate(at.rotation, one) for one in ((tx, ty, tz), (fx, fy, fz)))
        bullet, client, world = self._bullet, self._client, self._bullet.WORLD_FRAME
        bullet.applyExternalForce(self.index, -1, force, at.position, world, client)
        bullet.applyExternalTorque(self.index, -1, torque, world, client)

    def centre_pose(self) -> Pose:
        """Return the pose in the world of the base's centre of mass, along its principal axes."""
        centre, orientation = self._bullet.getBasePositionAndOrientation(self.index, self._client)
        return Pose(centre, geometry.rotation_from_quaternion(orientation))

    def base_pose(self) -> Pose:
        """Return the pose in the world of the base's URDF frame; the engine tells the centre's."""
        centre, orientation = self._bullet.getBasePositionAndOrientation(self.index, self._client)
        rotation = geometry.multiply(
            geometry.rotation_from_quaternion(orientation),
            geometry.transposed(self._inertial_in_base),
        )
        offset = geometry.rotate(rotation, self._com_in_base)
        return Pose(geometry.subtract(centre, offset), rotation)

    def base_velocity(self) -> tuple[Vector, Vector]:
        """Return the velocity of the base's centre of mass and its angular velocity, in world."""
        linear, angular = self._bullet.getBaseVelocity(self.index, self._client)
        return linear, angular

    def reset(
        self,
        angles: Sequence[float],
        rates: Sequence[float],
        base_velocity: tuple[Vector, Vector] | None = None,
    ) -> None:
        """Put the body at its start pose with these joint angles and rates.

        The base moves as the plan says, or with the velocity of its centre of mass and the
        angular velocity given.
        """
        start = self._body.start
        frame = start.pose
        rotation = geometry.multiply(frame.rotation, self._inertial_in_base)
        # setting the pose zeroes the velocity, so pose comes first
        self._bullet.resetBasePositionAndOrientation(
            self.index,
            frame.point(self._com_in_base),
            geometry.quaternion_from_rotation(rotation),
            self._client,
        )
        if self._body.base != "static":
            linear, angular = base_velocity or self._start_velocity(frame)
            self._bullet.resetBaseVelocity(
                self.index, linear, angular, physicsClientId=self._client
            )
        for joint, angle, rate in zip(self._joints, angles, rates, strict=True):
            self._bullet.resetJointState(self.index, joint, angle, rate, self._client)

    def _start_velocity(self, frame: Pose) -> tuple[Vector, Vector]:
        """Return the start velocity of the base's centre of mass: v + ω x r, and ω."""
        start = self._body.start
        x, y, z = geometry.rotate(frame.rotation, self._com_in_base)
        wx, wy, wz = start.angular_velocity
        swing = (wy * z - wz * y, wz * x - wx * z, wx * y - wy * x)
        return geometry.add(start.linear_velocity, swing), start.angular_velocity

    def _joint_indices(self) -> list[int]:
        bullet, client = self._bullet, self._client
        by_name = {}
        for index in range(bullet.getNumJoints(self.index, client)):
            by_name[bullet.getJointInfo(self.index, index, client)[1].decode()] = index
        missing = [joint.name for joint in self._body.chain.joints if joint.name not in by_name]
        if missing or len(by_name) != len(self._body.chain.joints):
            raise EngineRefused(self._body.name, f"{len(by_name)} joints, missing {missing}")
        return [by_name[joint.name] for joint in self._body.chain.joints]

    def _release(self) -> None:
        """Switch off what is in nobody's model: engine damping, rate clamp, joint motors.

        Motors stay where the plan wants their rows, with a torque that does nothing.
        """
        bullet, body, client = self._bullet, self.index, self._client
        for number, link in enumerate(self.links):
            bullet.changeDynamics(
                body,
                link,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                maxJointVelocity=UNLIMITED_RATE,
                physicsClientId=client,
            )
            # seen in 3.2.7: said together with a rate, a link's surface is not heard, only a base's
            surface = settings(self._body.surfaces.of(number, self._body.chain))
            bullet.changeDynamics(body, link, **surface, physicsClientId=client)
        # every joint has a velocity motor by default; with zero force it is gone, with a force
        # it is dry friction of that torque
        least = IDLE_TORQUE if self._body.has_idle_motors else 0.0
        for index, joint in zip(self._joints, self._body.chain.joints, strict=True):
            bullet.setJointMotorControl2(
                body,
                index,
                bullet.VELOCITY_CONTROL,
                targetVelocity=0,
                force=max(joint.friction, least),
                physicsClientId=client,
            )

    def _hold_base(self) -> None:
        start = self._body.start
        frame = start.pose
        inverse = geometry.transposed(self._inertial_in_base)
        origin = geometry.rotate(inverse, geometry.subtract(geometry.ZERO, self._com_in_base))
        self._bullet.createConstraint(
            self.index,
            -1,
            -1,
            -1,
            self._bullet.JOINT_FIXED,
            [0, 0, 0],
            origin,
            start.position,
            geometry.quaternion_from_rotation(inverse),
            geometry.quaternion_from_rotation(frame.rotation),
            physicsClientId=self._client,
        )

    def _base_inertial_frame(self) -> tuple[Vector, geometry.Matrix]:
        dynamics = self._bullet.getDynamicsInfo(self.index, -1, self._client)
        return dynamics[3], geometry.rotation_from_quaternion(dynamics[4])

    def _read_back(self) -> None:
        """Compare what the engine understood with what was compiled.

        This catches an inertia the engine would not take, cut lines and misread numbers.
        """
        bullet, client = self._bullet, self._client
        links, joints = [], []
        for index, link in enumerate(self.links):
            dynamics = bullet.getDynamicsInfo(self.index, link, client)
            has_mass = index > 0 or self._body.base != "static"  # a static base reads as mass 0
            links.append(EngineLink(dynamics[0], dynamics[3], dynamics[2]) if has_mass else None)
            if index > 0:
                told = bullet.getJointInfo(self.index, link, client)
                # the engine tells the axis in the principal axes of the child
                principal = geometry.rotation_from_quaternion(dynamics[4])
                axis = geometry.rotate(principal, told[13])
                joints.append(EngineJoint(told[16], axis, told[8], told[9]))
        chain = self._body.chain
        meant = chain if self._body.has_engine_limits else chain.without_limits()
        found = mismatches(meant, links, joints)
        if found:
            more = f"; and {len(found) - 3} more" if len(found) > 3 else ""
            raise EngineRefused(self._body.name, "; ".join(found[:3]) + more)
