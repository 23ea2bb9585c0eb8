"""One body in PyBullet: loading, releasing and reading it back, its motion and its dynamics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.problems import EngineRefused
from somo_cli.simulation.engine.bullet.client import BulletClient
from somo_cli.simulation.engine.bullet.contact_parameters import surface_settings
from somo_cli.simulation.engine.bullet.dynamics import BulletDynamics
from somo_cli.simulation.engine.bullet.self_collision import disable_near_collisions
from somo_cli.simulation.engine.readback import EngineJoint, EngineLink, mismatches
from somo_cli.simulation.plan.model import Body

MAX_UNNAMED_JOINTS = 40  # for more joints, unused positional arrays cost more than keywords
UNLIMITED_RATE = 1e12  # rad/s; the engine's own clamp of 100 hides divergence
# engine units; seen in 3.2.7: a motor gets a solver row if its force times the time step is not 0.
# With this force it changes no rate, except one of exactly 0, and that by less than about 1e-290
ZERO_EFFECT_TORQUE = 1e-300


class BulletBody(BulletDynamics):
    """One manipulator in the engine; joints in the order of its chain, engine units."""

    def __init__(self, engine: BulletClient, body: Body, gravity: Vector, path: str) -> None:
        # the inertia must come from the file, or the engine computes
        # its own from the collision shapes
        flags = engine.URDF_USE_INERTIA_FROM_FILE | engine.URDF_USE_IMPLICIT_CYLINDER
        if body.has_self_collision:
            flags |= engine.URDF_USE_SELF_COLLISION
        index: int = engine.loadURDF(
            path,
            useFixedBase=body.base == "static",
            flags=flags,
        )
        super().__init__(engine, index, body, gravity)
        self._joints = self._joint_indices()
        # bound once, so that no Python call stands between loop and engine; it returns one tuple
        # per joint, base to tip, that starts with angle and rate
        self.joint_states: Callable[[], Any] = partial(
            engine.module.getJointStates, index, self._joints, engine.number
        )
        self.apply = self._make_apply()
        self._check_readback()
        self._disable_engine_defaults()
        if body.has_self_collision:
            disable_near_collisions(engine, self.index, self.links, body.chain)
        self._com_in_base, self._inertial_in_base = self._base_inertial_frame()
        self.reset(body.start.angles, body.start.rates)
        self._update_gravity_in_base()
        if body.base == "constrained":
            self._constrain_base()

    def _make_apply(self) -> Callable[[Sequence[float]], None]:
        """Return a function that applies joint torques, from base to tip, during the next step."""
        index, joints, client = self.index, self._joints, self.engine.number
        module = self.engine.module
        control, mode = module.setJointMotorControlArray, module.TORQUE_CONTROL

        # seen in 3.2.7: keywords cost a quarter of the call for ten joints. Without them it needs
        # positions, rates and gains as well, which it reads but does not use in this mode
        def apply(torques: Sequence[float]) -> None:
            control(index, joints, mode, torques, torques, torques, torques, torques, client)

        def apply_to_many(torques: Sequence[float]) -> None:
            control(index, joints, mode, forces=torques, physicsClientId=client)

        return apply if len(joints) <= MAX_UNNAMED_JOINTS else apply_to_many

    @property
    def links(self) -> tuple[int, ...]:
        """The engine's numbers of the links, base to tip."""
        return (-1, *self._joints)

    def apply_base_wrench(self, wrench: Array, centre: Pose | None = None) -> None:
        """Apply a torque and a force, shape (6,), to the base's centre of mass in the next step.

        In the base's own axes, as those of `bias`; for `centre` see there.
        """
        at = centre or self.base_inertial_pose()
        tx, ty, tz, fx, fy, fz = wrench.tolist()
        torque, force = (geometry.rotate(at.rotation, one) for one in ((tx, ty, tz), (fx, fy, fz)))
        engine, client, world = self.engine.module, self.engine.number, self.engine.WORLD_FRAME
        engine.applyExternalForce(self.index, -1, force, at.position, world, client)
        engine.applyExternalTorque(self.index, -1, torque, world, client)

    def base_pose(self) -> Pose:
        """Return the world pose of the base's URDF frame; the engine reports the centre of mass."""
        centre = self.base_inertial_pose()
        rotation = geometry.multiply(centre.rotation, geometry.transposed(self._inertial_in_base))
        offset = geometry.rotate(rotation, self._com_in_base)
        return Pose(geometry.subtract(centre.position, offset), rotation)

    def base_velocity(self) -> tuple[Vector, Vector]:
        """Return the velocity of the base's centre of mass and its angular velocity, in world."""
        linear, angular = self._base_velocity()
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
        self.engine.resetBasePositionAndOrientation(
            self.index,
            frame.point(self._com_in_base),
            geometry.quaternion_from_rotation(rotation),
        )
        if self._body.base != "static":
            linear, angular = base_velocity or self._start_velocity(frame)
            self.engine.resetBaseVelocity(self.index, linear, angular)
        for joint, angle, rate in zip(self._joints, angles, rates, strict=True):
            self.engine.resetJointState(self.index, joint, angle, rate)

    def _start_velocity(self, frame: Pose) -> tuple[Vector, Vector]:
        """Return the start velocity of the base's centre of mass: v + ω x r, and ω."""
        start = self._body.start
        x, y, z = geometry.rotate(frame.rotation, self._com_in_base)
        wx, wy, wz = start.angular_velocity
        swing = (wy * z - wz * y, wz * x - wx * z, wx * y - wy * x)
        return geometry.add(start.linear_velocity, swing), start.angular_velocity

    def _joint_indices(self) -> list[int]:
        engine = self.engine
        by_name = {}
        for index in range(engine.getNumJoints(self.index)):
            by_name[engine.getJointInfo(self.index, index)[1].decode()] = index
        missing = [joint.name for joint in self._body.chain.joints if joint.name not in by_name]
        if missing or len(by_name) != len(self._body.chain.joints):
            raise EngineRefused(self._body.name, f"{len(by_name)} joints, missing {missing}")
        return [by_name[joint.name] for joint in self._body.chain.joints]

    def _disable_engine_defaults(self) -> None:
        """Switch off what the model does not have: engine damping, rate clamp, joint motors.

        Where the plan wants solver rows for motors, they stay, with a torque of no effect.
        """
        engine, body = self.engine, self.index
        for number, link in enumerate(self.links):
            engine.changeDynamics(
                body,
                link,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                maxJointVelocity=UNLIMITED_RATE,
            )
            # seen in 3.2.7: set together with a rate, the surface of a link is ignored, except the
            # base's, so it needs a call of its own
            surface = surface_settings(self._body.surfaces.of_link(number, self._body.chain))
            engine.changeDynamics(body, link, **surface)
        # every joint has a velocity motor by default; with zero force it is gone, with a force
        # it is dry friction of that torque
        least = ZERO_EFFECT_TORQUE if self._body.has_zero_torque_motors else 0.0
        for index, joint in zip(self._joints, self._body.chain.joints, strict=True):
            engine.setJointMotorControl2(
                body,
                index,
                engine.VELOCITY_CONTROL,
                targetVelocity=0,
                force=max(joint.friction, least),
            )

    def _constrain_base(self) -> None:
        start = self._body.start
        frame = start.pose
        inverse = geometry.transposed(self._inertial_in_base)
        origin = geometry.rotate(inverse, geometry.subtract(geometry.ZERO, self._com_in_base))
        self.engine.createConstraint(
            self.index,
            -1,
            -1,
            -1,
            self.engine.JOINT_FIXED,
            [0, 0, 0],
            origin,
            start.position,
            geometry.quaternion_from_rotation(inverse),
            geometry.quaternion_from_rotation(frame.rotation),
        )

    def _base_inertial_frame(self) -> tuple[Vector, geometry.Matrix]:
        dynamics = self.engine.getDynamicsInfo(self.index, -1)
        return dynamics[3], geometry.rotation_from_quaternion(dynamics[4])

    def _check_readback(self) -> None:
        """Compare what the engine has loaded with what was compiled.

        This catches an inertia that the engine rejected, truncated lines and misread numbers.
        """
        engine = self.engine
        links, joints = [], []
        for index, link in enumerate(self.links):
            dynamics = engine.getDynamicsInfo(self.index, link)
            has_mass = index > 0 or self._body.base != "static"  # a static base reads as mass 0
            links.append(EngineLink(dynamics[0], dynamics[3], dynamics[2]) if has_mass else None)
            if index > 0:
                info = engine.getJointInfo(self.index, link)
                # the engine reports the axis in the principal axes of the child
                principal = geometry.rotation_from_quaternion(dynamics[4])
                axis = geometry.rotate(principal, info[13])
                joints.append(EngineJoint(info[16], axis, info[8], info[9]))
        chain = self._body.chain
        expected = chain if self._body.has_engine_limits else chain.without_limits()
        found = mismatches(expected, links, joints)
        if found:
            more = f"; and {len(found) - 3} more" if len(found) > 3 else ""
            raise EngineRefused(self._body.name, "; ".join(found[:3]) + more)
