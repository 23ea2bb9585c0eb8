"""A long box slides askew in plain PyBullet, whatever its parameters."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import pybullet

FRICTION, G, SPEED = 0.35, 9.81, 1.17
HEADING, YAW = 0.9, 0.3  # rad
PARAMETERS: Mapping[str, Mapping[str, float]] = {
    "50 iterations": {"numSolverIterations": 50},
    "1000 iterations": {"numSolverIterations": 1000, "solverResidualThreshold": 0.0},
    "friction as a pyramid": {"enableConeFriction": 0},
    "no contact is kept": {"contactBreakingThreshold": 0.0},
    "slop of zero": {"contactSlop": 0.0},
}


def aside(step: float, parameters: Mapping[str, float]) -> tuple[float, float]:
    """Return how far too far and aside a long box stops, over v²/(2 μ g)."""
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setPhysicsEngineParameter(fixedTimeStep=step, physicsClientId=client, **parameters)
        pybullet.setGravity(0, 0, -G, physicsClientId=client)
        bodies = []
        for mass, half in ((0.0, (5, 5, 1)), (0.5, (0.1, 0.02, 0.01))):
            shape = pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client
            )
            height = -1.0 if mass == 0 else 0.01
            turn = (0, 0, math.sin(YAW / 2), math.cos(YAW / 2)) if mass else (0, 0, 0, 1)
            bodies.append(
                pybullet.createMultiBody(
                    mass, shape, -1, (0, 0, height), turn, physicsClientId=client
                )
            )
        ground, box = bodies
        for body, friction in ((ground, 1.0), (box, FRICTION)):
            pybullet.changeDynamics(
                body,
                -1,
                lateralFriction=friction,
                linearDamping=0,
                angularDamping=0,
                physicsClientId=client,
            )
        ahead = math.cos(HEADING), math.sin(HEADING)
        pybullet.resetBaseVelocity(
            box, (SPEED * ahead[0], SPEED * ahead[1], 0), physicsClientId=client
        )
        for _ in range(round(1.2 * SPEED / (FRICTION * G) / step)):
            pybullet.stepSimulation(client)
        (x, y, _), _ = pybullet.getBasePositionAndOrientation(box, client)
    finally:
        pybullet.disconnect(client)
    distance = SPEED**2 / (2 * FRICTION * G)
    return (x * ahead[0] + y * ahead[1]) / distance - 1, (y * ahead[0] - x * ahead[1]) / distance


def rows() -> Iterator[tuple[str, float, float]]:
    """Yield what was tried, how far too far the box stops and how far aside."""
    for step in (2e-3, 1e-3, 1e-4):
        yield f"step {1e3 * step:g} ms", *aside(step, {})
    for name, parameters in PARAMETERS.items():
        yield name, *aside(1e-3, parameters)
