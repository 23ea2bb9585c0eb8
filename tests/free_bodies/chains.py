"""Chains that spin in free space, and their energy and momentum as the simulation has them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator.geometry import Vector
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.plan.model import Plan
from somo_cli.simulation.session import Session
from tests.builders.definitions import Data, actuator, hinge, manipulator
from tests.builders.scenes import scene_from_text

AXES: tuple[Vector, ...] = ((0.5, 0.6, 0.62), (1.0, 0.1, 0.05))


def _undamped(stiffness: float, *axis: float) -> Data:
    limits = [-3, 3, 1e4, 1e3]
    return hinge(*axis, limits=limits, spring_stiffness=stiffness, spring_damping=0.0)


STIFF = manipulator(
    actuator(
        2,
        _undamped(500.0, 1, 0, 0),
        link={"shape_type": "box", "dimensions": [0.1, 0.06, 0.03], "mass": 0.3},
    )
)
SOFT = manipulator(
    actuator(
        4,
        _undamped(0.5, 1, 0, 0),
        _undamped(0.5, 0, 1, 0),
        link={"shape_type": "box", "dimensions": [0.03, 0.02, 0.03], "mass": 0.03},
    )
)
CHAINS = {"stiff chain": STIFF, "soft chain": SOFT}


@dataclass(frozen=True)
class ChainMotion:
    """Rows: the whole energy [J], and the angular momentum about the centre of mass, (rows, 3)."""

    energies: Array
    momenta: Array

    def swing(self) -> float:
        """Return the largest relative error of the energy."""
        return float(np.abs(self.energies / self.energies[0] - 1).max())

    def drift(self) -> float:
        """Return by how much the mean of the energy changed from the first quarter to the last."""
        part = len(self.energies) // 4
        change = self.energies[-part:].mean() - self.energies[:part].mean()
        return float(change / self.energies[0])

    def momentum_error(self) -> float:
        """Return the largest relative error of the momentum."""
        off = np.linalg.norm(self.momenta - self.momenta[0], axis=1)
        return float(off.max() / np.linalg.norm(self.momenta[0]))


def chain_plan(
    definition: Data,
    spin: Vector,
    time_step: float,
    loads: Sequence[Mapping[str, object]] = (),
    **scene: object,
) -> Plan:
    """Return the plan of a chain with a free base that starts at a spin [rad/s], weightless."""
    one = {
        "name": "chain",
        "definition": definition,
        "base": "free",
        "rpy": [0.3, -0.5, 0.9],
        "angular_velocity": spin,
        **({"loads": list(loads)} if loads else {}),
    }
    whole = {"gravity": [0, 0, 0], "time_step": time_step, "manipulators": [one], **scene}
    return make_plan(scene_from_text(json.dumps(whole)))


def spin_of(axis: Vector, size: float) -> Vector:
    """Return an angular velocity of this size [rad/s] about an axis."""
    x, y, z = (np.array(axis) / np.linalg.norm(axis) * size).tolist()
    return x, y, z


def chain_motion(plan: Plan, time: float, every: int = 7) -> ChainMotion:
    """Simulate a plan of one free chain for so long [s]; rows at every so many steps.

    Velocities live at half steps, so those of a row are the mean of both sides.
    """
    energies, momenta = [], []
    with BulletWorld(plan) as world:
        session = Session(plan, world)
        (stepper,), (body,) = session.steppers, world.bodies
        chain = ChainDynamics(plan.bodies[0].chain)

        def velocities() -> Array:
            velocity, spin = body.base_velocity()
            return np.array([*spin, *velocity, *stepper.law.rates])

        for step in range(round(time / plan.time_step)):
            session.monitor()
            session.actuate()
            pose, before = chain.at(stepper.law.angles, body.base_pose()), velocities()
            session.advance(step + 1)
            if step % every == 0:
                mean = 0.5 * (before + velocities())
                momentum = pose.mass_matrix() @ mean
                energies.append(0.5 * momentum @ mean + pose.elastic_energy())
                centre = chain.masses @ pose.centres / chain.masses.sum()
                arm = pose.centres[0] - centre
                momenta.append(momentum[:3] + np.cross(arm, momentum[3:6]))
    return ChainMotion(np.array(energies), np.array(momenta))
