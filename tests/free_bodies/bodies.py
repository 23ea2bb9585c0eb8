"""Bodies that spin, and their motion as the simulation has it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from somo_cli.arrays import Array
from somo_cli.manipulator import geometry
from tests.builders.definitions import actuator, hinge, manipulator
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text

_URDF = (
    '<robot name="body"><link name="link"><inertial><mass value="{mass!r}"/>'
    '<inertia ixx="{0!r}" iyy="{1!r}" izz="{2!r}" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><sphere radius="{radius!r}"/></geometry></collision></link></robot>'
)
_NAME = "body.urdf"


@dataclass(frozen=True)
class Spinning:
    """A ball of any moments [kg·m²] that starts at an angular velocity [rad/s] and rolls, or not.

    Its principal axes are those of the world at the start.
    """

    name: str
    moments: tuple[float, float, float]
    rate: tuple[float, float, float]
    rolls: bool = False
    mass: float = 1.0  # kg
    radius: float = 0.1  # m

    @property
    def momentum(self) -> Array:
        """The angular momentum that is kept [kg·m²/s]: about the centre, or where it touches."""
        return self.momentum_at(np.eye(3), np.array(self.rate))

    def momentum_at(self, rotation: Array, rate: Array) -> Array:
        """Return the same for any orientation and rate."""
        own: Array = rotation @ (np.array(self.moments) * (rotation.T @ rate))
        if self.rolls:
            own += self.mass * self.radius**2 * (rate - np.array([0, 0, rate[2]]))
        return own

    def energy_at(self, rotation: Array, rate: Array) -> float:
        """Return the kinetic energy [J]."""
        return 0.5 * float(rate @ self.momentum_at(rotation, rate))


@dataclass(frozen=True)
class Motion:
    """A body in rows: times [s], orientations (rows, 3, 3), angular velocities (rows, 3)."""

    times: Array
    rotations: Array
    rates: Array

    def energies(self, body: Spinning) -> Array:
        """Return the energy relative to that of the start, less one."""
        states = zip(self.rotations, self.rates, strict=True)
        start = body.energy_at(np.eye(3), np.array(body.rate))
        return np.array([body.energy_at(*state) for state in states]) / start - 1

    def momenta(self, body: Spinning) -> Array:
        """Return how far the momentum is from that of the start, relative to its size."""
        states = zip(self.rotations, self.rates, strict=True)
        off = np.array([body.momentum_at(*state) for state in states]) - body.momentum
        return np.linalg.norm(off, axis=1) / np.linalg.norm(body.momentum)


def simulated_motion(
    body: Spinning, folder: Path, time_step: float, time: float, every: int = 1, **scene: object
) -> Motion:
    """Simulate a body for so long [s]; `folder` takes its URDF, `scene` adds to the scene."""
    urdf = _URDF.format(*body.moments, mass=body.mass, radius=body.radius)
    (folder / _NAME).write_text(urdf, encoding="utf-8")
    far = {"definition": manipulator(actuator(1, hinge(1, 0, 0))), "position": [40, 0, 1]}
    wx, wy, _ = body.rate
    one: dict[str, object] = {
        "name": "o",
        "shape_type": "urdf",
        "urdf": _NAME,
        "angular_velocity": body.rate,
    }
    whole: dict[str, object] = {"gravity": [0, 0, 0]}
    if body.rolls:
        speed = [wy * body.radius, -wx * body.radius, 0]
        one |= {"position": [0, 0, body.radius], "friction": 10, "linear_velocity": speed}
        whole = {"ground": {"friction": 10}}
    whole |= {
        "time_step": time_step,
        "manipulators": [far],
        "objects": [one],
        "record": {"every": every, "columns": ["tip_position"], "objects": ["pose", "velocity"]},
        **scene,
    }
    text = json.dumps(whole)
    rows = np.array(
        rows_of(scene_from_text(text, source=str(folder / "scene.yaml")), steps_of(time, time_step))
    )
    return Motion(rows[:, 0], _rotations(rows[:, 7:11]), rows[:, 14:17])


def steps_of(time: float, time_step: float) -> int:
    """Return the number of steps in so much time."""
    return round(time / time_step)


def _rotations(quaternions: Array) -> Array:
    return np.array([geometry.rotation_from_quaternion(tuple(one)) for one in quaternions.tolist()])
