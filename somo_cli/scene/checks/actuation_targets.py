"""Check which trajectories, limbs, actuators and axes the entries of `actuation` name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
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
from somo_cli.scene.checks.actuation import names_actuators


@dataclass(frozen=True, slots=True)
class _NamedActuator:
    """An actuator that an entry names: its limb, its number in the limb, and the entry's pointer.

    `limb` is empty for a manipulator without limbs.
    """

    limb: str
    number: int
    at: Pointer

    def __str__(self) -> str:
        return f"actuator {self.number}" + (f" of limb '{self.limb}'" if self.limb else "")


def actuation_target_problems(
    document: Document,
    at: Pointer,
    entries: list[Any],
    compiled: Compiled,
    channel_counts: Mapping[str, int | None],
) -> Iterator[Problem]:
    """Yield the errors in what the entries at `at` drive.

    Errors are trajectories, limbs, actuators and axes that do not exist, axes driven twice, and
    pressure on joints without one torque per pressure. `channel_counts` has the number of channels
    of each trajectory of the scene, None if it is unknown.
    """
    axes_by_limb = _axes_by_limb(compiled.chain)
    driven: set[tuple[str, int, int]] = set()
    for number, entry in enumerate(entries):
        place: Pointer = (*at, number)
        yield from _mix_problems(document, place, entry, channel_counts)
        if not names_actuators(entry):
            continue
        in_limbs = list(limbs_checks.limb_problems(document, place, entry, compiled.definition))
        yield from in_limbs
        if not in_limbs:
            yield from _axis_problems(document, place, entry, compiled, axes_by_limb, driven)


def _axis_problems(
    document: Document,
    at: Pointer,
    data: Mapping[str, Any],
    compiled: Compiled,
    axes_by_limb: Mapping[str, Mapping[int, set[int]]],
    driven: set[tuple[str, int, int]],
) -> Iterator[Problem]:
    """Yield the errors of the axes that an entry drives; add these axes to `driven`."""
    axis = int(data["axis"])
    for actuator in _named_actuators(at, data, compiled):
        target = (actuator.limb, actuator.number, axis)
        missing = _missing_axis(document, at, actuator, axis, axes_by_limb[actuator.limb])
        if missing is not None:
            yield missing
        elif target in driven:
            message = f"{actuator}, axis {axis} is driven twice"
            hint = "keep one entry, or add the torques"
            yield Problem(document.span(actuator.at), message, hint)
        elif is_pressure(data):
            yield from _pressure_problems(document, at, data, compiled, actuator)
        driven.add(target)


def _missing_axis(
    document: Document,
    at: Pointer,
    actuator: _NamedActuator,
    axis: int,
    axes: Mapping[int, set[int]],
) -> Problem | None:
    """Return the error of an actuator or axis that its limb does not have, else None."""
    if actuator.number not in axes:
        owner = f"limb '{actuator.limb}' has" if actuator.limb else "there is"
        message = f"{owner} no actuator {actuator.number}"
        hint = _known_numbers_hint("actuator", axes)
        return Problem(document.span(actuator.at), message, hint)
    if axis not in axes[actuator.number]:
        hint = _known_numbers_hint("axis", axes[actuator.number])
        return Problem(document.span((*at, "axis")), f"{actuator} has no axis {axis}", hint)
    return None


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
    actuator: _NamedActuator,
) -> Iterator[Problem]:
    """Yield an error unless all joints of the axis have the same torque per pressure."""
    place = document.span((*at, "pressure" if "pressure" in data else "input"), key=True)
    axis = int(data["axis"])
    joints = f"the joints of {actuator}, axis {axis}"
    number = actuator.number
    if actuator.limb:
        number = compiled.definition.actuators_of(actuator.limb)[number]
    try:
        is_known = torque_per_pressure(compiled.definition, number, axis) is not None
    except AmbiguousTorquePerPressure:
        yield Problem(place, f"{joints} differ in torque_per_pressure", "give all of them the same")
        return
    if not is_known:
        yield Problem(
            place,
            f"{joints} have no torque_per_pressure",
            "give it in their joint definition, or drive them by torque; "
            "somo calibrate torque finds it",
        )


def _named_actuators(
    at: Pointer, data: Mapping[str, Any], compiled: Compiled
) -> Iterator[_NamedActuator]:
    """Yield each actuator that the entry `data` at `at` names, limb by limb."""
    definition = compiled.definition
    counts = [("", len(definition.actuators))]
    if definition.limbs:
        limbs = driven_limbs(data, definition)
        counts = [(limb, len(definition.actuators_of(limb))) for limb in limbs]
    key = "actuators" if "actuators" in data else "actuator"
    is_list = isinstance(data.get("actuators"), list)
    for limb, count in counts:
        for index, number in enumerate(driven_actuator_numbers(data, count)):
            yield _NamedActuator(limb, number, (*at, key, index) if is_list else (*at, key))


def _axes_by_limb(chain: Chain) -> Mapping[str, Mapping[int, set[int]]]:
    """Return the axes of each actuator, by limb and by the number of the actuator in the limb."""
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
