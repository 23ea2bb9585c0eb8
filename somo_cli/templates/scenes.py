"""Scenes and studies to start from, as YAML with comments."""

from __future__ import annotations

import math
from typing import NamedTuple

from somo_cli.templates.sizes import Sizes

GRASPED_RADIUS = 0.025  # m, of the ball between the fingers of a gripper
GRASPED_MASS = 0.05  # kg


class Varied(NamedTuple):
    """What a study varies: a name for it, its path in the scene, its value there, what to look at."""

    name: str
    path: str
    value: float
    column: str


def bending_scene(name: str, definition: str, torque: float | None) -> str:
    """Return a scene of one manipulator that stands and, with a torque [N·m], bends about x."""
    driven = (
        f"""
    actuation:
      - {{actuator: 0, axis: 0, waypoints: [[0, 0], [0.5, {torque:.3g}]], interpolation: cubic}} # s, N m"""
        if torque is not None
        else """
    # actuation: # the torque in each joint of an axis
    #   - {actuator: 0, axis: 0, waypoints: [[0, 0], [0.5, 0.01]], interpolation: cubic} # s, N m"""
    )
    return f"""# somo run {name}.yaml
duration: 2 # s
time_step: 1e-3 # s; somo report {name}.yaml says what it costs and errs
gravity: [0, 0, -9.81] # m/s^2
manipulators:
  - definition: {definition}
    position: [0, 0, 0] # m
    rpy: [0, 0, 0] # rad; [3.14159, 0, 0] hangs
    base: static # or free, constrained{driven}
record:
  every: 10 # steps
  columns: [joint_angles, tip_position] # somo columns {name}.yaml lists all
"""


def snake_scene(name: str, definition: str, sizes: Sizes) -> str:
    """Return a scene in which a snake crawls over the ground by friction that has a direction."""
    return f"""# A wave of torque runs along the snake, and its belly slides along the body ten times more easily
# than across, as a snake's scales do. somo run {name}.yaml
duration: 2 # s
time_step: 1e-3 # s
ground: {{friction: 1}}
manipulators:
  - definition: {definition}
    position: [{-sizes.length / 2:.4g}, 0, {sizes.width / 2:.4g}] # m: on the ground, along x
    rpy: [0, {math.pi / 2!r}, 0] # rad
    base: free
    surface:
      friction: 0.5
      anisotropic_friction: [1, 1, 0.1] # factors along the axes of each link; z is along the body
      contact_stiffness: 1500 # N/m: a soft belly shares its weight among its points
      contact_damping: 10 # N s/m
    actuation:
      - actuators: all
        axis: 0
        wave: {{amplitude: {sizes.torque(sizes.length / 0.4):.3g}, frequency: 1, lag: {math.pi / 4!r}}} # N m, Hz, rad
record:
  every: 20 # steps
  columns: [base_pose, joint_angles, tip_position]
"""


def gripper_scene(name: str, definition: str, sizes: Sizes, fingers: int) -> str:
    """Return a scene in which fingers that hang in a ring close on a ball and lift it."""
    away = GRASPED_RADIUS + 1.2 * sizes.depth
    height = sizes.length + 0.01 + sizes.depth / 2 + 0.5 * GRASPED_RADIUS
    rows = "".join(
        _finger(number, fingers, definition, away, height, sizes) for number in range(fingers)
    )
    return f"""# {fingers} fingers hang over the ground, close on a ball and lift it: their bases are moved, the ball is
# held by friction alone. somo run {name}.yaml --error
duration: 2 # s
time_step: 1e-3 # s
ground: {{friction: 0.5}}
manipulators:
{rows}objects:
  - name: ball
    shape_type: sphere
    dimensions: [{GRASPED_RADIUS:g}] # radius, m
    mass: {GRASPED_MASS:g} # kg
    friction: 1
    position: [0, 0, 0]
    place: {{on: ground}}
record:
  every: 10 # steps
  columns: [joint_angles, tip_position, base_pose, contact_force]
  objects: [pose, contact_force]
"""


def study(name: str, scene: str, varied: Varied) -> str:
    """Return a study that varies one number of a scene."""
    values = ", ".join(f"{factor * varied.value:.3g}" for factor in (0.5, 1.0, 1.5, 2.0))
    return f"""# somo sweep {name}.yaml --dry-run shows what would run; without it, {name}_results/results.csv has a
# row for each set of parameters, and somo plot draws it.
scene: {scene}
duration: 1 # s
parameters:
  {varied.name}: {{path: "{varied.path}", values: [{values}]}}
labels:
  end: {{of: {varied.column}, take: last}}
  swing: {{of: {varied.column}, take: range}}
"""


def _finger(
    number: int, count: int, definition: str, away: float, height: float, sizes: Sizes
) -> str:
    yaw = number * 2 * math.pi / count
    x, y = away * math.sin(yaw), -away * math.cos(yaw)
    head = "&" if number == 0 else "*"
    if number == 0:
        driven = f"""    surface: &skin {{friction: 1}}
    actuation: &closing
      - {{actuator: 0, axis: 0, waypoints: [[0.1, 0], [0.5, {sizes.torque(1.2):.3g}]]}} # s, N m in each joint
    motion: &lifting
      translation: [[0.8, 0, 0, 0], [1.4, 0, 0, 0.05]] # s, m
"""
    else:
        driven = (
            f"    surface: {head}skin\n    actuation: {head}closing\n    motion: {head}lifting\n"
        )
    return f"""  - name: finger_{number}
    definition: {definition}
    base: constrained
    position: [{x:.6g}, {y:.6g}, {height:.6g}] # m
    rpy: [{math.pi!r}, 0, {yaw:.9g}] # rad: it hangs, and bends inwards
{driven}"""
