"""Scenes of the shipped definitions and of text, read by the same stages as the command line."""

from __future__ import annotations

from pathlib import Path

from somo_cli.loading import load_text, scene_of
from somo_cli.scene.model import Scene

DEFINITIONS = Path(__file__).parents[2] / "definitions"

JOINTS = "manipulators[0].definition.actuator_definitions[0].joint_definitions"
"""The path of `--set` to the joints of the first actuator of a scene's first manipulator."""


def scene_from_text(text: str, *sets: str, source: str = str(DEFINITIONS / "test.yaml")) -> Scene:
    """Read a scene, or a definition as the scene of it alone; paths are those of definitions/."""
    return scene_of(load_text(text, source, sets))[0]


def scene_from_file(name: str, *sets: str) -> Scene:
    """Read a scene of definitions/."""
    path = DEFINITIONS / name
    return scene_from_text(path.read_text("utf-8"), *sets, source=str(path))
