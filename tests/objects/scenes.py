"""Scenes of objects as they are found, whose files lie in `inputs/`."""

from __future__ import annotations

from pathlib import Path

from somo_cli.loading import load, scene_of
from somo_cli.problems import InvalidFile, Problem
from somo_cli.scene.model import Scene

INPUTS = Path(__file__).parent / "inputs"


def scene(name: str, *sets: str) -> Scene:
    """Return the scene of a file of `inputs/`."""
    return scene_of(load(str(INPUTS / name), sets))[0]


def problems(name: str, *sets: str) -> tuple[Problem, ...]:
    """Return what is said of a file of `inputs/`, as a command would say it."""
    try:
        return scene_of(load(str(INPUTS / name), sets))[1]
    except InvalidFile as error:
        return tuple(error.problems)
