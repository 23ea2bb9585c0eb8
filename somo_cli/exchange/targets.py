"""Which format and scale each program wants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from somo_cli.manipulator.dimensions import Scale

Format = Literal["urdf", "sdf", "mjcf"]
Program = Literal["pybullet", "gazebo", "mujoco", "drake", "isaac"]

SUFFIXES: dict[Format, str] = {"urdf": ".urdf", "sdf": ".sdf", "mjcf": ".xml"}


@dataclass(frozen=True, slots=True)
class Target:
    """A format, whether it is in SI whatever the file says, and what its joints must have.

    With `has_all_limits`, a continuous joint has effort and velocity too, which some importers of
    URDF ask of every joint.
    """

    format: Format
    is_si: bool = True
    has_all_limits: bool = False


PROGRAMS: dict[Program, Target] = {
    "pybullet": Target("urdf", is_si=False),
    "gazebo": Target("sdf"),
    "mujoco": Target("mjcf"),
    "drake": Target("sdf"),
    "isaac": Target("urdf", has_all_limits=True),
}

FORMATS: dict[Format, Target] = {
    "urdf": Target("urdf", is_si=False),
    "sdf": Target("sdf"),
    "mjcf": Target("mjcf"),
}


def scale_note(scale: Scale) -> str:
    """Return what a URDF at a world scale is, for a message; empty in SI."""
    if scale == Scale():
        return ""
    size = f"{scale.length:g} times its size" if scale.length != 1 else "its own size"
    mass = f" and {scale.mass:g} times its mass" if scale.mass != 1 else ""
    return f"{size}{mass}, for PyBullet; --scale 1 for other tools"
