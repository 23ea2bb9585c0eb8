"""Faults of what drives an axis: torque, pressure, way-points, a wave or a mixed trajectory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import Compiled
from somo_cli.problems import Pointer, Problem
from somo_cli.scene.actuation import (
    AmbiguousTorquePerPressure,
    driven_actuator_numbers,
    driven_limbs,
    is_pressure,
    torque_per_pressure,
)
from somo_cli.scene.checks import limbs as limbs_checks
from somo_cli.scene.checks.waypoints import waypoint_problems

_INPUT_KEYS = ("torque", "pressure", "wave", "trajectory", "waypoints")
_INPUTS_BY_KEY: Mapping[str, tuple[str, ...]] = {
    "interpolation": ("waypoints",),
    "repeat": ("waypoints",),
    "mix": ("trajectory",),
    "input": ("waypoints", "wave", "trajectory"),
}
"""Keys that have a meaning beside some of the ways only."""


def actuation_problems(
    document: Document, at: Pointer, data: Mapping[str, Any]
) -> Iterator[Problem]:
    """Yield the faults of the entry `data` at `at` that need no look at the manipulator."""
    if ("actuator" in data) == ("actuators" in data):
        has_both = "actuator" in data
        yield Problem(
            document.span((*at, "actuators") if has_both else at, key=True),
            "both actuator and actuators are given" if has_both else "missing key 'actuator'",
            "keep one of them" if has_both else "name one actuator, or several with actuators",
        )
    given = [key for key in _INPUT_KEYS if key in data]
    if not given:
        yield Problem(
            document.span(at, key=True),
            "missing torque, pressure, wave, trajectory or waypoints",
            "give a constant torque or pressure, or waypoints: [[time, torque], ...]",
        )
        return
    if len(given) > 1:
        yield Problem(
            document.span((*at, given[-1]), key=True),
            f"both {given[0]} and {given[-1]} are given",
            "they exclude each other: keep one of them",
        )
        return
    (input_key,) = given
    constant = "a constant " if input_key in ("torque", "pressure") else ""
    for key, inputs in _INPUTS_BY_KEY.items():
        if key in data and input_key not in inputs:
            yield Problem(
                document.span((*at, key), key=True),
                f"{key} has no meaning beside {constant}{input_key}",
                f"leave it out, or give {inputs[0]} in place of {input_key}",
            )
    if input_key == "waypoints":
        unit = " Pa" if data.get("input") == "pressure" else " N·m"
        yield from waypoint_problems(document, at, data, data.get("input", "torque"), unit)
    if input_key == "trajectory" and "mix" not in data:
        yield Problem(
            document.span((*at, "trajectory"), key=True),
            "a trajectory needs a mix",
            "give mix: one weight per channel, such as [0.5, -0.5]",
        )
    if input_key == "wave":
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


def actuation_target_problems(
    document: Document,
    at: Pointer,
    entries: list[Any],
    compiled: Compiled,
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    """Yield the faults of entries at `at` that name what there is not.

    `channel_counts` says how many each trajectory of the scene has, None where that is not known.
    """
    axes_of_limbs = _axes_of_limbs(compiled.chain)
    seen: set[tuple[str, int, int]] = set()
    for number, entry in enumerate(entries):
        place: Pointer = (*at, number)
        yield from _mix_problems(document, place, entry, channel_counts)
        if ("actuator" in entry) == ("actuators" in entry):
            continue
        of_limbs = list(limbs_checks.limb_problems(document, place, entry, compiled.definition))
        yield from of_limbs
        if of_limbs:
            continue
        axis = int(entry["axis"])
        for limb, index, actuator in _named_actuators(entry, compiled):
            axes = axes_of_limbs[limb]
            of = f" of limb '{limb}'" if limb else ""
            where: Pointer = (*place, "actuator")
            if "actuators" in entry:
                is_list = isinstance(entry["actuators"], list)
                where = (*place, "actuators", index) if is_list else (*place, "actuators")
            if actuator not in axes:
                hint = _known_numbers_hint("actuator", axes)
                message = f"there is no actuator {actuator}"
                message = f"limb '{limb}' has no actuator {actuator}" if limb else message
                yield Problem(document.span(where), message, hint)
            elif axis not in axes[actuator]:
                message = f"actuator {actuator}{of} has no axis {axis}"
                hint = _known_numbers_hint("axis", axes[actuator])
                yield Problem(document.span((*place, "axis")), message, hint)
            elif (limb, actuator, axis) in seen:
                message = f"actuator {actuator}{of}, axis {axis} is driven twice"
                hint = "keep one entry, or add the torques"
                yield Problem(document.span(where), message, hint)
            elif is_pressure(entry):
                number = compiled.definition.actuators_of(limb)[actuator] if limb else actuator
                joints = f"the joints of actuator {actuator}{of}, axis {axis}"
                yield from _pressure_problems(document, place, entry, compiled, number, joints)
            seen.add((limb, actuator, axis))


def _mix_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    name = data.get("trajectory")
    if name is None:
        return
    if name not in channel_counts:
        known = ", ".join(f"'{one}'" for one in channel_counts)
        hint = f"known ones: {known}" if known else "the scene has no trajectories"
        place = document.span((*at, "trajectory"))
        yield Problem(place, f"there is no trajectory '{name}'", hint)
        return
    count = channel_counts[name]
    if count is not None and "mix" in data and len(data["mix"]) != count:
        yield Problem(
            document.span((*at, "mix")),
            f"mix has {len(data['mix'])} weights for the {count} channels of '{name}'",
            "give one weight per channel, 0 for those that do nothing here",
        )


def _pressure_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    compiled: Compiled,
    actuator: int,
    joints: str,
) -> Iterator[Problem]:
    key = "pressure" if "pressure" in data else "input"
    axis = int(data["axis"])
    try:
        is_known = torque_per_pressure(compiled.definition, actuator, axis) is not None
    except AmbiguousTorquePerPressure:
        message = f"{joints} differ in torque_per_pressure"
        yield Problem(document.span((*at, key), key=True), message, "give all of them the same")
        return
    if not is_known:
        yield Problem(
            document.span((*at, key), key=True),
            f"{joints} have no torque_per_pressure",
            "give it in their joint definition, or drive them by torque; "
            "somo calibrate torque finds it",
        )


def _named_actuators(data: Mapping[str, Any], compiled: Compiled) -> Iterator[tuple[str, int, int]]:
    """Yield limb, place in the entry's list and number of each actuator that an entry names."""
    definition = compiled.definition
    if not definition.limbs:
        for index, actuator in enumerate(driven_actuator_numbers(data, len(definition.actuators))):
            yield "", index, actuator
        return
    for limb in driven_limbs(data, definition):
        count = len(definition.actuators_of(limb))
        for index, actuator in enumerate(driven_actuator_numbers(data, count)):
            yield limb, index, actuator


def _axes_of_limbs(chain: Chain) -> Mapping[str, Mapping[int, set[int]]]:
    """Return the axes by limb and by the limb's own number of the actuator."""
    axes: dict[str, dict[int, set[int]]] = {}
    for joint in chain.joints:
        limb = chain.backbone_of(joint)
        of_limb = axes.setdefault(limb.name, {})
        of_limb.setdefault(joint.actuator - limb.first_actuator, set()).add(joint.channel)
    return axes


def _known_numbers_hint(noun: str, numbers: Iterable[int]) -> str:
    known = [str(number) for number in sorted(numbers)]
    if len(known) == 1:
        return f"the only {noun} is {known[0]}"
    return f"the {'axes' if noun == 'axis' else noun + 's'} are {', '.join(known)}"
