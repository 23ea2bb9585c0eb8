"""Rigid-body dynamics of a chain at one pose, as arrays: inertia, energies, loads, stiffness.

No engine is needed, so `check` runs without one, and results of an engine are compared with these.
Coordinates are the base's angular velocity and the velocity of its centre of mass, both in the
world frame, then the joint rates: 6 + n of them. Link 0 is the base; joint i moves link i + 1, and
joints of a limb are in series. Everything is in the units of the chain.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.geometry import Vector
from somo_cli.manipulator.kinematics import Pose
from somo_cli.simulation.dynamics.cross_products import skew_matrices
from somo_cli.simulation.dynamics.free_base import FreeBase
from somo_cli.simulation.dynamics.link_frames import LinkFrames


class ChainDynamics:
    """The arrays of a chain that do not depend on its pose; `at` gives the chain at a pose."""

    def __init__(self, chain: Chain) -> None:
        joints, links = chain.joints, chain.links
        self.count = len(joints)
        self.masses: Array = np.array([link.inertial.mass for link in links])
        self.centres: Array = np.array([link.inertial.centre for link in links])
        self.inertias: Array = np.array([_inertia_matrix(link.inertial.inertia) for link in links])
        self.axes: Array = np.array([joint.axis for joint in joints]).reshape(-1, 3)
        self.stiffness: Array = np.array([joint.stiffness for joint in joints])
        self.damping: Array = np.array([joint.damping for joint in joints])
        self.neutral: Array = np.array([joint.neutral_position for joint in joints])
        self.tip: Array = np.array(chain.tip)
        self.tips = tuple((limb.last_link, np.array(limb.tip)) for limb in chain.backbones)
        # joints in series, and for each link the joints that move it: [first of its limb, link)
        self.limbs = tuple(slice(limb.first, limb.last) for limb in chain.backbones)
        self.moving_joints = (
            slice(0, 0),
            *(slice(one.start, link) for one in self.limbs for link in _moved_links(one)),
        )
        self.moved_by: Array = np.zeros((self.count + 1, self.count))  # link l is moved by joint j
        for link, way in enumerate(self.moving_joints):
            self.moved_by[link, way] = 1.0
        self.frames = LinkFrames(chain)

    def at(self, angles: Sequence[float] | Array, base: Pose | None = None) -> ChainPose:
        """Return the chain at these joint angles [rad]; the base at the world's origin if None."""
        return ChainPose(self, np.asarray(angles, dtype=np.float64), base or Pose())


class ChainPose:
    """A chain at one pose; vectors and points in the world frame."""

    def __init__(self, chain: ChainDynamics, angles: Array, base: Pose) -> None:
        frames = chain.frames.at(angles, base)
        self.chain = chain
        self.angles = angles
        self.rotations: Array = frames[:, :3, :3]  # of the link frames, (n + 1, 3, 3)
        self.origins: Array = frames[:, :3, 3]  # of the link frames, (n + 1, 3)
        self.axes: Array = np.einsum("ijk,ik->ij", self.rotations[1:], chain.axes)  # (n, 3)
        self.centres: Array = self.origins + np.einsum("ijk,ik->ij", self.rotations, chain.centres)

    def point(self, link: int, local: Sequence[float] | Array) -> Array:
        """Return the world position of a point given in the frame of a link."""
        place: Array = self.origins[link] + self.rotations[link] @ np.asarray(local)
        return place

    @property
    def tip(self) -> Array:
        """The position of the tip, shape (3,); with several limbs that of the last."""
        return self.point(*self.chain.tips[-1])

    def tip_jacobians(self) -> tuple[Array, ...]:
        """Return the Jacobian of the tip of each limb, (3, n) each, with the base held."""
        return tuple(
            np.cross(self.axes, self.point(link, tip) - self.origins[1:]).T
            * self.chain.moved_by[link]
            for link, tip in self.chain.tips
        )

    def mass_matrix(self) -> Array:
        """Return the inertia of base and joints, shape (6 + n, 6 + n).

        M = sum of m Jv' Jv + Jw' I Jw over the links: Featherstone, Rigid Body Dynamics
        Algorithms (2008), eq. 2.60 and 6.4, written out.
        """
        count = self.chain.count + 1
        linear, angular = self._jacobians()
        inertias = self.rotations @ self.chain.inertias @ self.rotations.transpose(0, 2, 1)
        weighted = (linear * self.chain.masses[:, np.newaxis, np.newaxis]).reshape(3 * count, -1)
        turning = (inertias @ angular).reshape(3 * count, -1)
        matrix: Array = linear.reshape(3 * count, -1).T @ weighted
        matrix += angular.reshape(3 * count, -1).T @ turning
        return matrix

    def joint_inertia(self, has_free_base: bool = False) -> Array:
        """Return the inertia that the joints feel, shape (n, n), with the base held or free."""
        matrix = self.mass_matrix()
        return FreeBase.of(matrix).joint_inertia if has_free_base else matrix[6:, 6:]

    def _jacobians(self) -> tuple[Array, Array]:
        """Return the Jacobians of all centres of mass and of all spins, (n + 1, 3, 6 + n) each."""
        n = self.chain.count
        linear, angular = np.zeros((2, n + 1, 3, 6 + n))
        angular[:, :, :3] = np.eye(3)
        linear[:, :, 3:6] = np.eye(3)
        linear[:, :, :3] = -skew_matrices(self.centres - self.centres[0])
        moved_by = self.chain.moved_by
        arms = self.centres[:, np.newaxis] - self.origins[np.newaxis, 1:]
        swing = np.cross(self.axes[np.newaxis], arms) * moved_by[:, :, np.newaxis]
        linear[:, :, 6:] = swing.transpose(0, 2, 1)
        angular[:, :, 6:] = (moved_by[:, :, np.newaxis] * self.axes).transpose(0, 2, 1)
        return linear, angular

    def generalised_force(self, link: int, point: Array, force: Array, moment: Array) -> Array:
        """Return the generalised force, shape (6 + n,), of a force and a moment on a link.

        `point` is where the force acts, in the world. The first six are the moment about the
        base's centre of mass and the force, then come the joint torques.
        """
        generalised: Array = np.zeros(6 + self.chain.count)
        # r x F as r times a matrix: numpy's cross is slow, and this runs in every step
        x, y, z = force.tolist()
        cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
        way = self.chain.moving_joints[link]
        moments = (point - self.origins[1:][way]) @ cross
        moments += moment
        generalised[:3] = moment + (point - self.centres[0]) @ cross
        generalised[3:6] = force
        generalised[6:][way] = np.einsum("ij,ij->i", self.axes[way], moments)
        return generalised

    def force_stiffness(self, link: int, point: Array, force: Array) -> Array:
        """Return the joint stiffness, (n, n), of a force fixed in the world: minus dτ/dq.

        d/dq_j of a_i x (p - o_i) is a_j x (a_i x (p - o_i)) for j <= i.
        """
        n = self.chain.count
        stiffness: Array = np.zeros((n, n))
        way = self.chain.moving_joints[link]
        arms = point - self.origins[1:][way]
        stiffness[way, way] = _series_stiffness(force, self.axes[way], arms)
        return stiffness

    def gravity_force(self, gravity: Vector) -> Array:
        """Return the generalised force of gravity, shape (6 + n,)."""
        linear, _ = self._jacobians()
        weights = self.chain.masses[:, np.newaxis] * np.array(gravity)
        generalised: Array = np.einsum("lkc,lk->c", linear, weights)
        return generalised

    def gravity_stiffness(self, gravity: Vector) -> Array:
        """Return the joint stiffness of gravity, (n, n); not positive where the chain may topple.

        As `force_stiffness`, with the mass that each joint carries at its common centre.
        """
        n = self.chain.count
        stiffness: Array = np.zeros((n, n))
        for limb in self.chain.limbs:
            masses = self.chain.masses[1:][limb, np.newaxis]
            carried = np.cumsum(masses[::-1], axis=0)[::-1]
            moments = np.cumsum((masses * self.centres[1:][limb])[::-1], axis=0)[::-1]
            arms = moments - carried * self.origins[1:][limb]
            own = _series_stiffness(np.array(gravity), self.axes[limb], arms)
            stiffness[limb, limb] = own
        return stiffness

    def kinetic_energy(self, rates: Sequence[float] | Array) -> float:
        """Return the kinetic energy at these rates, shape (6 + n,), those of the base first."""
        linear, angular = self._jacobians()
        speeds, spins = linear @ np.asarray(rates), angular @ np.asarray(rates)
        local = np.einsum("ikj,ik->ij", self.rotations, spins)
        turning = np.einsum("ij,ijk,ik->", local, self.chain.inertias, local)
        return 0.5 * float(self.chain.masses @ np.einsum("ij,ij->i", speeds, speeds) + turning)

    def elastic_energy(self) -> float:
        """Return the energy in the springs."""
        deflection = self.angles - self.chain.neutral
        return 0.5 * float(self.chain.stiffness @ deflection**2)

    def gravity_energy(self, gravity: Vector) -> float:
        """Return the energy in the field of gravity, zero at the world's origin."""
        return -float(self.chain.masses @ self.centres @ np.array(gravity))


def _moved_links(joints: slice) -> range:
    """Return which links each of several joints in series moves."""
    return range(joints.start + 1, joints.stop + 1)


def _series_stiffness(force: Array, axes: Array, arms: Array) -> Array:
    """Return minus F · (a_j x (a_i x r_i)), (m, m), j <= i, of m joints in series, mirrored."""
    # F · (a_j x b) = (F x a_j) · b; numpy's cross is slow, and this may run in many steps
    (turn,) = skew_matrices(force[np.newaxis])
    swings = np.einsum("ijk,ik->ij", skew_matrices(axes), arms)
    upper = np.triu((axes @ turn.T) @ swings.T)
    stiffness: Array = -(upper + np.triu(upper, 1).T)
    return stiffness


def _inertia_matrix(inertia: tuple[float, float, float, float, float, float]) -> list[list[float]]:
    xx, xy, xz, yy, yz, zz = inertia
    return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
