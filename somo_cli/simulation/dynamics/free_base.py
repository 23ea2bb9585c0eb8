"""A free base eliminated from the equations of motion: the inertia that its joints feel.

With the inertia of a body in blocks, base first, and no forces but those given,

    M_b a_b + M_bj a_j = f_b,   M_jb a_b + M_j a_j = f_j,

the joints move as if the base were not there, with the inertia M_j - M_jb M_b⁻¹ M_bj (a Schur
complement) under the forces f_j - M_jb M_b⁻¹ f_b.
"""

from __future__ import annotations

from dataclasses import dataclass

from somo_cli.arrays import Array, invert


@dataclass(frozen=True, slots=True)
class FreeBase:
    """The effect of a free base on n joints; the base has the coordinates of M.

    `inverse` is M_b⁻¹, shape (6, 6), `to_joints` M_jb M_b⁻¹, shape (n, 6), and `joint_inertia` the
    inertia that the joints feel, shape (n, n).
    """

    inverse: Array
    to_joints: Array
    joint_inertia: Array

    @staticmethod
    def of(inertia: Array) -> FreeBase:
        """Eliminate the base from an inertia of base and joints, shape (6 + n, 6 + n)."""
        across = inertia[:6, 6:]
        inverse = invert(inertia[:6, :6])
        to_joints = across.T.dot(inverse)
        reduced = inertia[6:, 6:] - to_joints.dot(across)
        return FreeBase(inverse, to_joints, (reduced + reduced.T) / 2)

    def joint_torques(self, forces: Array) -> Array:
        """Return the joint torques, shape (n,), that accelerate the joints as these forces do.

        The forces, shape (6 + n,), are those on the base, then those on the joints.
        """
        felt: Array = forces[6:] - self.to_joints.dot(forces[:6])
        return felt
