"""Where a chain comes to rest, and how soon, by arrays alone."""

from __future__ import annotations

import numpy as np

from somo_cli.arrays import Array
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics, ChainPose
from somo_cli.simulation.plan.model import Plan


def equilibrium(plan: Plan, angles: Array) -> ChainPose | None:
    """Return the equilibrium next to these joint angles, by Newton; None where it finds none.

    K (q - q0) = u + gravity, of a base that does not move.
    """
    (body,) = plan.bodies
    chain = ChainDynamics(body.chain)
    torques = np.zeros(chain.count)
    for drive in body.drives:
        torques[list(drive.joints)] += drive.signal.at(0.0)
    stiffness = np.diag(chain.stiffness)
    for _ in range(60):
        pose = chain.at(angles, body.start.pose)
        rest = torques - chain.stiffness * (angles - chain.neutral)
        rest += pose.gravity_force(plan.gravity)[6:]
        gradient = stiffness + pose.gravity_stiffness(plan.gravity)
        try:
            change = np.linalg.solve(gradient, rest)
        except np.linalg.LinAlgError:
            return None
        angles = angles + change
        if np.abs(change).max() < 1e-13 * (1 + np.abs(angles).max()):
            return chain.at(angles, body.start.pose)
    return None


def slowest_decay(plan: Plan, pose: ChainPose) -> float:
    """Return the rate [1/s] of the slowest motion about an equilibrium; negative if it grows."""
    mass = pose.joint_inertia()
    # about unit masses, so that large and small joints keep their digits
    scale = 1 / np.sqrt(np.diag(mass))
    stiffness = np.diag(pose.chain.stiffness) + pose.gravity_stiffness(plan.gravity)
    unit, k, d = (
        scale[:, np.newaxis] * matrix * scale
        for matrix in (mass, stiffness, np.diag(pose.chain.damping))
    )
    zero, one = np.zeros_like(k), np.eye(len(k))
    motion = np.block([[zero, one], [-np.linalg.solve(unit, k), -np.linalg.solve(unit, d)]])
    return -float(np.linalg.eigvals(motion).real.max())
