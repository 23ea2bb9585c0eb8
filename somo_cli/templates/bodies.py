"""Definitions to start from, as YAML with comments."""

from __future__ import annotations

import math

from somo_cli.templates.sizes import DAMPING_RATIO, Sizes


def finger(name: str, sizes: Sizes) -> str:
    """Return the definition of a finger: one actuator, a base, a round tip."""
    radius = min(sizes.width, sizes.depth) / 2
    mass = sizes.density * 4 / 3 * math.pi * radius**3
    return f"""# A soft finger: it stands along z on its base, and bends about x and y.
{_numbers(sizes)}manipulator_name: {name}
world_scale: 20 # engine units per metre; contact of small bodies needs it

base_definition:
  shape_type: box
  dimensions: [{1.4 * sizes.width:.4g}, {1.4 * sizes.width:.4g}, 0.01] # m
  mass: 0.1 # kg

actuator_definitions:
{_actuator(sizes, sizes.segments, "- ")}
tip_definition:
  shape_type: sphere
  dimensions: [{radius:.4g}] # radius, m
  mass: {mass:.4g} # kg
"""


def arm(name: str, sizes: Sizes, actuators: int) -> str:
    """Return the definition of an arm: some actuators in series."""
    more = "  - *actuator\n" * (actuators - 1)
    return f"""# A soft arm of {actuators} actuators in series, each of which bends about x and y by itself.
{_numbers(sizes)}manipulator_name: {name}
world_scale: 5 # engine units per metre

base_definition:
  shape_type: box
  dimensions: [{2 * sizes.width:.4g}, {2 * sizes.width:.4g}, 0.02] # m
  mass: 1 # kg

actuator_definitions:
{_actuator(sizes, sizes.segments // actuators, "- &actuator ")}{more}"""


def snake(name: str, sizes: Sizes, actuators: int) -> str:
    """Return the definition of a snake: actuators in series that bend in one plane."""
    more = "  - *actuator\n" * (actuators - 1)
    return f"""# A flat snake of {actuators} actuators in series, which bend about x: laid on its side, in the plane of
# the ground. It has no base: its first link is half a segment.
{_numbers(sizes)}manipulator_name: {name}
world_scale: 20 # engine units per metre

actuator_definitions:
{_actuator(sizes, sizes.segments // actuators, "- &actuator ")}{more}"""


def _numbers(sizes: Sizes) -> str:
    """Return the comment that says where the numbers come from."""
    takes_turns = (
        ", which stands for two segments since the axes take turns," if sizes.axes == 2 else ""
    )
    return f"""#
# {sizes.length:g} m long, section {sizes.width:g} x {sizes.depth:g} m, {sizes.segments} segments.
# Modulus E = {sizes.modulus:g} Pa, density {sizes.density:g} kg/m^3:
#   mass of a segment = density * width * depth * length of a segment = {sizes.segment_mass:.4g} kg
#   a joint{takes_turns} has E I over its length of beam, {sizes.span:.4g} m
#   damping for a damping ratio of {DAMPING_RATIO:g} in the lowest mode: assumed, measure it
# somo calibrate finds these from measurements.
"""


def _actuator(sizes: Sizes, segments: int, start: str) -> str:
    """Return one actuator of so many segments, as an item of a list."""
    joints = "".join(_joint(sizes, axis) for axis in "xy"[: sizes.axes])
    return f"""  {start}
    n_segments: {segments}
    planar_flag: {int(sizes.axes == 1)} # {"all joints about x" if sizes.axes == 1 else "the joints below take turns"}
    link_definition:
      shape_type: box
      dimensions: [{sizes.width:.4g}, {sizes.depth:.4g}, {sizes.segment:.4g}] # x, y, z, m
      mass: {sizes.segment_mass:.4g} # kg
      material_color: [0.54, 0.41, 0.69, 1]
      material_name: soft
    joint_definitions:
{joints}""".replace("- \n    n_segments", "- n_segments")


def _joint(sizes: Sizes, axis: str) -> str:
    direction = "[1, 0, 0]" if axis == "x" else "[0, 1, 0]"
    return f"""      - joint_type: revolute
        axis: {direction}
        limits: [-1.5, 1.5, 5, 10] # rad, rad, N m, rad/s
        spring_stiffness: {sizes.stiffness(axis):.4g} # N m/rad
        spring_damping: {sizes.damping(axis):.4g} # N m s/rad
"""
