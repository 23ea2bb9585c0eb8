"""Check what drives an axis: a torque, a pressure, waypoints, a wave or a mix of channels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.checks.waypoints import waypoint_problems

_INPUT_KEYS = ("torque", "pressure", "wave", "trajectory", "waypoints")
_INPUTS_BY_KEY: Mapping[str, tuple[str, ...]] = {
    "interpolation": ("waypoints",),
    "repeat": ("waypoints",),
    "mix": ("trajectory",),
    "input": ("waypoints", "wave", "trajectory"),
}
"""For each key, the inputs that it may be given with."""


def actuation_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield the errors of the entry `data` at `at` that can be found without its manipulator."""
    yield from _actuator_key_problems(document, at, data)
    given = [key for key in _INPUT_KEYS if key in data]
    if not given:
        yield Problem(
            document.span(at, key=True),
            "missing torque, pressure, wave, trajectory or waypoints",
            "give a constant torque or pressure, or waypoints: [[time, torque], ...]",
        )
    elif len(given) > 1:
        yield Problem(
            document.span((*at, given[-1]), key=True),
            f"both {given[0]} and {given[-1]} are given",
            "they exclude each other: keep one of them",
        )
    else:
        yield from _foreign_key_problems(document, at, data, given[0])
        yield from _input_problems(document, at, data, given[0])


def names_actuators(data: Mapping[str, Any]) -> bool:
    """Return whether an entry has exactly one of the keys actuator and actuators."""
    return ("actuator" in data) != ("actuators" in data)


def _actuator_key_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    if names_actuators(data):
        return
    if "actuator" in data:
        place = document.span((*at, "actuators"), key=True)
        yield Problem(place, "both actuator and actuators are given", "keep one of them")
    else:
        hint = "name one actuator, or several with actuators"
        yield Problem(document.span(at, key=True), "missing key 'actuator'", hint)


def _foreign_key_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], input_key: str
) -> Iterator[Problem]:
    """Yield an error for each key that belongs to other inputs than `input_key`."""
    constant = "a constant " if input_key in ("torque", "pressure") else ""
    for key, inputs in _INPUTS_BY_KEY.items():
        if key in data and input_key not in inputs:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} has no meaning beside {constant}{input_key}",
                f"leave it out, or give {inputs[0]} in place of {input_key}",
            )


def _input_problems(
    document: Document, at: Pointer, data: Mapping[str, Any], input_key: str
) -> Iterator[Problem]:
    if input_key == "waypoints":
        unit = " Pa" if data.get("input") == "pressure" else " N·m"
        yield from waypoint_problems(document, at, data, data.get("input", "torque"), unit)
    elif input_key == "trajectory" and "mix" not in data:
        yield Problem(
            document.span((*at, "trajectory"), key=True),
            "a trajectory needs a mix",
            "give mix: one weight per channel, such as [0.5, -0.5]",
        )
    elif input_key == "wave":
        yield from _wave_problems(document, at, data)


def _wave_problems(document: Document, at: Pointer, data: Mapping[str, Any]) -> Iterator[Problem]:
    wave = data["wave"]
    if "lag" in wave and "actuators" not in data and "limbs" not in data:
        yield Problem(
            document.span((*at, "wave", "lag"), key=True),
            "lag has no meaning with one actuator",
            "name several with actuators, or use phase",
        )
    if "rise" in wave and wave.get("shape") != "trapezoid":
        yield Problem(
            document.span((*at, "wave", "rise"), key=True),
            f"rise has no meaning for a {wave.get('shape', 'sine')}",
            "leave it out, or use shape: trapezoid",
        )
