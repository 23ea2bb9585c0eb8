"""A spinning top on the ground: a disc on a thin stick with a round tip, against the heavy top."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

import somo_cli as somo
from somo_cli.loading import load_text

MASS, RADIUS, THICKNESS, HEIGHT, G = 0.05, 0.03, 0.005, 0.03, 9.81  # SI
TILT = 0.2  # rad
AXIAL = MASS * RADIUS**2 / 2
ACROSS = MASS * (3 * RADIUS**2 + THICKNESS**2) / 12
URDF = """\
<robot name="top"><link name="top">
  <inertial><origin xyz="0 0 {height}"/><mass value="{mass}"/>
    <inertia ixx="{across}" iyy="{across}" izz="{axial}" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin xyz="0 0 {tip}"/><geometry><sphere radius="{tip}"/></geometry></collision>
  <collision><origin xyz="0 0 {height}"/>
    <geometry><cylinder radius="{radius}" length="{thickness}"/></geometry></collision>
</link></robot>
"""


def steady_precession(spin: float, tip: float) -> float:
    """Return the slow rate of steady precession of a top about its tip [rad/s].

    The centre of the tip stands still: with l from it to the centre of mass, I₁ cos θ p² - I₃ ω₃ p
    + m g l = 0 (Goldstein, Classical Mechanics, 3rd ed., eq. 5.76).
    """
    arm = HEIGHT - tip
    a, b = (ACROSS + MASS * arm**2) * math.cos(TILT), -AXIAL * spin
    return (-b - math.sqrt(b * b - 4 * a * MASS * G * arm)) / (2 * a)


def measured_precession(folder: Path, spin: float, tip: float, step: float) -> tuple[float, float]:
    """Return the rate of precession [rad/s] in half a second, and the largest rise [rad]."""
    urdf = URDF.format(
        height=HEIGHT,
        mass=MASS,
        across=ACROSS,
        axial=AXIAL,
        tip=tip,
        radius=RADIUS,
        thickness=THICKNESS,
    )
    (folder / "top.urdf").write_text(urdf, "utf-8")
    axis = np.array([math.sin(TILT), 0.0, math.cos(TILT)])
    turn = steady_precession(spin, tip)
    angular = turn * np.array([0.0, 0.0, 1.0]) + (spin - turn * math.cos(TILT)) * axis
    linear = np.cross(angular, (HEIGHT - tip) * axis)
    top = {
        "name": "top",
        "shape_type": "urdf",
        "urdf": "top.urdf",
        "friction": 5,
        "position": (np.array([0, 0, tip]) - tip * axis).tolist(),
        "rpy": [0, TILT, 0],
        "linear_velocity": linear.tolist(),
        "angular_velocity": angular.tolist(),
    }
    scene = {
        "time_step": step,
        "world_scale": 20,
        "ground": {"friction": 1},
        "objects": [top],
        "record": {"every": max(1, round(0.01 / step)), "objects": ["pose"]},
    }
    document = load_text(json.dumps(scene), str(folder / "top_scene.yaml"))
    result = somo.simulate(document, steps=round(0.5 / step))
    x, y, z, w = (result[f"top.pose.q{part}"] for part in "xyzw")
    heading = np.unwrap(np.arctan2(2 * (y * z - w * x), 2 * (x * z + w * y)))
    tilts = np.arccos(1 - 2 * (x * x + y * y))
    return float(np.polyfit(result.time, heading, 1)[0]), float(TILT - tilts.min())
