"""Momenta and centres of mass of a body, from the engine and from the plan."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from somo_cli.manipulator import geometry
from somo_cli.simulation import run
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.model import Plan


def momentum(world: BulletWorld, plan: Plan) -> tuple[np.ndarray, np.ndarray]:
    """Return linear and angular momentum about the origin, in engine units, from the engine."""
    body: Any = world.bodies[0]
    bullet, index, client = body.engine.module, body.index, body.engine.number
    links = range(-1, bullet.getNumJoints(index, client))
    linear, angular = np.zeros(3), np.zeros(3)
    for link in links:
        if link < 0:
            centre, orientation = bullet.getBasePositionAndOrientation(index, client)
            velocity, spin = bullet.getBaseVelocity(index, client)
        else:
            state = bullet.getLinkState(index, link, 1, 1, client)
            centre, orientation, velocity, spin = state[0], state[1], state[6], state[7]
        dynamics = bullet.getDynamicsInfo(index, link, client)
        axes = np.array(geometry.rotation_from_quaternion(orientation))
        linear += dynamics[0] * np.array(velocity)
        angular += np.cross(centre, dynamics[0] * np.array(velocity))
        angular += axes @ (np.array(dynamics[2]) * (axes.T @ np.array(spin)))
    return linear, angular


def loss_of_momentum(plan: Plan) -> np.ndarray:
    """Return the change of linear and angular momentum in half a second, relative to their size."""
    with BulletWorld(plan) as world:
        before = momentum(world, plan)
        run.run(plan, world, lambda row: None, round(0.5 / plan.time_step), time.perf_counter)
        after = momentum(world, plan)
    pairs = zip(before, after, strict=True)
    return np.array([np.linalg.norm(b - a) / np.linalg.norm(a) for a, b in pairs])


def centre_of_mass(world: BulletWorld) -> np.ndarray:
    """Return the centre of mass of the first body, in engine units, from the engine."""
    body: Any = world.bodies[0]
    bullet, index, client = body.engine.module, body.index, body.engine.number
    total, masses = np.zeros(3), 0.0
    for link in range(-1, bullet.getNumJoints(index, client)):
        if link < 0:
            centre = bullet.getBasePositionAndOrientation(index, client)[0]
        else:
            centre = bullet.getLinkState(index, link, 0, 1, client)[0]
        mass = bullet.getDynamicsInfo(index, link, client)[0]
        total += mass * np.array(centre)
        masses += mass
    return total / masses


def velocity_of_centre(plan: Plan) -> np.ndarray:
    """Return the velocity of the centre of mass at the start [m/s]: v + ω x r, the body stiff."""
    chain, start = plan.bodies[0].chain, plan.bodies[0].start
    origin, moment, masses = np.zeros(3), np.zeros(3), 0.0
    for index, link in enumerate(chain.links):
        origin = origin + (np.array(chain.joints[index - 1].origin) if index else 0.0)
        moment += link.inertial.mass * (origin + link.inertial.centre)
        masses += link.inertial.mass
    arm = np.array(geometry.rotation_from_rpy(start.rpy)) @ (moment / masses)
    velocity = np.array(start.linear_velocity) + np.cross(start.angular_velocity, arm)
    return velocity / plan.scale.length
