"""A pendulum of one hinge, whose motion is known in closed form."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from somo_cli.scene.model import Scene
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_text

# One link of 0.35 kg·m² about its hinge: a box, so heavy and so long, whose far end has the mass.
PENDULUM = """
manipulator_name: pendulum
actuator_definitions:
  - n_segments: 1
    link_definition:
      shape_type: box
      dimensions: [0.1, 0.2, 2]
      mass: 2.0
    joint_definitions:
      - {joint_type: continuous, axis: [1, 0, 0], spring_stiffness: 50, spring_damping: 0.5,
         joint_neutral_position: 0.3}
"""

# the moving half: 1 kg, 1 m long, 0.2 m wide; about its end m (w² + h²) / 12 + m h² / 4
PENDULUM_INERTIA = (0.2**2 + 1) / 12 + 0.25


def pendulum_scene(integrator: str, time_step: float, **more: object) -> Scene:
    """Return the pendulum without gravity, with changes of its manipulator."""
    scene = scene_from_text(PENDULUM)
    pendulum = dataclasses.replace(scene.manipulators[0], **more)  # type: ignore[arg-type]
    return dataclasses.replace(
        scene,
        integrator=integrator,
        time_step=time_step,
        gravity=(0.0, 0.0, 0.0),
        manipulators=(pendulum,),
        columns=("joint_angles", "joint_rates"),
    )


def pendulum_angle(
    times: np.ndarray, k: float = 50.0, d: float = 0.5, q0: float = 0.3
) -> np.ndarray:
    """Return the angle [rad] of I q'' + d q' + k (q - q0) = 0 from rest at zero."""
    decay = d / (2 * PENDULUM_INERTIA)
    omega = math.sqrt(k / PENDULUM_INERTIA - decay**2)
    wave = np.cos(omega * times) + decay / omega * np.sin(omega * times)
    return q0 - q0 * np.exp(-decay * times) * wave


def error_of_pendulum(integrator: str, time_step: float) -> float:
    """Return the largest error of the angle over one second [rad]."""
    rows = np.array(rows_of(pendulum_scene(integrator, time_step), round(1 / time_step)))
    return float(np.abs(rows[:, 1] - pendulum_angle(rows[:, 0])).max())
