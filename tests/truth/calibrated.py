"""Calibrated chains at rest: what a rule promises, simulated, against the beam and the gauge.

Two-axis fingers of 0.1 m, whose tip stiffness is to be that of Abondance and others' (IEEE Robot.
Autom. Lett. 5 (2020) 5502; SoMo's calibration notes): 6.12 N/m in the grasping axis, 29.05 N/m in
the side axis. They are pushed at the tip and come to rest in a run.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator

import numpy as np

from somo_cli.analysis import closed_forms
from somo_cli.calibration import moment_arms
from somo_cli.calibration.beam_comparison import compare_with_beam
from somo_cli.calibration.blocked_force import blocked_equilibrium
from somo_cli.calibration.moment_arms import MomentArms
from somo_cli.manipulator.definition import Placement
from somo_cli.scene.model import Scene
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text
from tests.truth.table import Row

LENGTH, MASS = 0.1, 0.03  # m, kg
WANTED = (6.12, 29.05)  # N/m
JOINTS = (3, 5, 10, 20, 40)
SMALL = 1e-4  # of the length: deflection
STEP, REST = 5e-3, 2.0  # s
DIRECTIONS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
FORCE, PRESSURE = 0.75, 1e5  # N, Pa: blocked force of the real finger, grasping


def axis_of(count: int, axis: int, placement: Placement = "uniform") -> MomentArms:
    """Return one axis of a finger with so many joints per axis."""
    return moment_arms.of_uniform_actuator(LENGTH, count, 2, axis, DIRECTIONS[axis], placement)


def finger(
    count: int, stiffness: tuple[float, float], placement: Placement = "uniform"
) -> dict[str, object]:
    """Return a finger with so many joints per axis, the first mode of each critically damped."""
    beams = [axis_of(count, axis).tip_stiffness(one) for axis, one in enumerate(stiffness)]
    frequencies = [3.516 * math.sqrt(beam / 3 / MASS) for beam in beams]
    joints = [
        {
            "joint_type": "continuous",
            "axis": list(direction),
            "spring_stiffness": one,
            "spring_damping": 2 * one / frequency,
        }
        for direction, one, frequency in zip(DIRECTIONS, stiffness, frequencies, strict=True)
    ]
    height = LENGTH / (2 * count)
    link = {"shape_type": "box", "dimensions": [0.02, 0.02, height], "mass": MASS / (2 * count)}
    actuator = {
        "n_segments": 2 * count,
        "joint_placement": placement,
        "link_definition": link,
        "joint_definitions": joints,
    }
    return {"manipulator_name": "finger", "world_scale": 20, "actuator_definitions": [actuator]}


def pushed(definition: dict[str, object], axis: int, force: float) -> Scene:
    """Return the weightless scene of a finger pushed across an axis by a force [N] on its tip."""
    across = np.cross(DIRECTIONS[axis], (0, 0, 1))
    load = {"force": (force * across).tolist(), "waypoints": [[0, 0], [0.2, 1]]}
    return scene_from_text(
        json.dumps(
            {
                "gravity": [0, 0, 0],
                "time_step": STEP,
                "manipulators": [{"definition": definition, "loads": [load]}],
                "record": {"every": round(REST / STEP), "columns": ["link_positions"]},
            }
        )
    )


def shape_at_rest(scene: Scene) -> np.ndarray:
    """Return the points of the backbone where links join, and the tip, at the end of a run."""
    scene = dataclasses.replace(scene, columns=("link_positions", "tip_position"))
    return np.array(rows_of(scene, round(REST / STEP)))[-1][1:].reshape(-1, 3)


def deflected(
    count: int, axis: int, stiffness: tuple[float, float], placement: Placement = "uniform"
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return heights and deflections [m] along a finger at rest, and the small force [N]."""
    force = SMALL * LENGTH * WANTED[axis]
    points = shape_at_rest(pushed(finger(count, stiffness, placement), axis, force))
    return points[:, 2], points @ np.cross(DIRECTIONS[axis], (0, 0, 1)), force


def exact(count: int, placement: Placement = "uniform") -> tuple[float, float]:
    """Return the joint stiffness of both axes by the exact rule."""
    first, second = (
        axis_of(count, axis, placement).stiffness(wanted) for axis, wanted in enumerate(WANTED)
    )
    return first, second


def tip_stiffness() -> Iterator[Row]:
    """Yield the simulated tip stiffness by the exact rule and by SoMo's formula."""
    for placement in ("uniform", "gauss"):
        for axis, wanted in enumerate(WANTED):
            for count in JOINTS:
                _, off, force = deflected(count, axis, exact(count, placement), placement)
                found = force / off[-1]
                case = f"axis {axis}, {placement}"
                what = "tip stiffness by the exact rule, simulated [N/m], relative error"
                yield Row(what, case, f"2 x {count} joints", found, wanted, abs(found / wanted - 1))
    for axis, wanted in enumerate(WANTED):
        for count in JOINTS:
            first, second = (axis_of(count, n).somo_stiffness(k) for n, k in enumerate(WANTED))
            _, off, force = deflected(count, axis, (first, second))
            found = force / off[-1]
            what = "tip stiffness by SoMo's formula, simulated [N/m], relative error"
            error = found / wanted - 1
            yield Row(what, f"axis {axis}", f"2 x {count} joints", found, wanted, error)


def along_the_length() -> Iterator[Row]:
    """Yield the largest error of the deflection along the length, and what is reported of it."""
    for placement in ("uniform", "gauss"):
        for axis, wanted in enumerate(WANTED):
            for count in JOINTS:
                heights, off, force = deflected(count, axis, exact(count, placement), placement)
                s = np.linspace(0, 1, 401)
                chain = np.interp(s * LENGTH, np.append(0, heights), np.append(0, off))
                beam = force / wanted * s * s * (3 - s) / 2
                found = float(np.abs(chain - beam).max() / (force / wanted))
                reported = compare_with_beam(axis_of(count, axis, placement), placement).along
                what = "deflection along the length against Euler-Bernoulli, over that of the tip"
                case = f"axis {axis}, {placement}"
                yield Row(what, case, f"2 x {count} joints", found, reported, abs(found - reported))


def large() -> Iterator[Row]:
    """Yield how far tips are from the elastica's under P L²/EI = 1, over the length."""
    for placement in ("uniform", "gauss"):
        for axis, wanted in enumerate(WANTED):
            force = axis_of(1, axis).rigidity(wanted) / LENGTH**2
            for count in JOINTS:
                scene = pushed(finger(count, exact(count, placement), placement), axis, force)
                tip = shape_at_rest(scene)[-1] / LENGTH
                across = float(tip @ np.cross(DIRECTIONS[axis], (0, 0, 1)))
                found = math.dist((tip[2], across), closed_forms.tip_load(1.0))
                reported = compare_with_beam(axis_of(count, axis, placement), placement).large
                what = "tip against the elastica, P L²/EI = 1, over the length"
                case = f"axis {axis}, {placement}"
                yield Row(what, case, f"2 x {count} joints", found, reported, abs(found - reported))


def blocked_force(torque: float, by_pressure: bool = False) -> float:
    """Return the force [N] with which the shipped finger presses, simulated.

    It is the force on the tip, across the finger, at which the tip stays where it is without
    torque: found by the secant method over runs to rest. The torque [N·m] is that of every joint
    of the grasping axis; by pressure it is what the definition makes of 100 kPa.
    """
    drive = f"pressure: {PRESSURE}" if by_pressure else f"torque: {torque!r}"

    def tip(force: float) -> float:
        one = "manipulators[0]"
        scene = scene_from_file(
            "scene.yaml",
            "gravity=[0, 0, 0]",
            f"time_step={STEP}",
            f"{one}.actuation=[{{actuator: 0, axis: 0, {drive}}}]",
            f"{one}.loads=[{{force: [0, {force!r}, 0]}}]",
            f"{one}.definition.actuator_definitions[0].joint_definitions[0].spring_damping=0.015",
            f"{one}.definition.actuator_definitions[0].joint_definitions[1].spring_damping=0.024",
        )
        # the axis turns the tip towards -y
        return float(shape_at_rest(scene)[-1] @ (0, 1, 0))

    (low, high), (at_low, at_high) = (0.9 * FORCE, 1.1 * FORCE), (0.0, 0.0)
    at_low, at_high = tip(low), tip(high)
    for _ in range(12):
        following_one = high - at_high * (high - low) / (at_high - at_low)
        low, at_low, high = high, at_high, following_one
        at_high = tip(high)
        if abs(high - low) < 1e-9:
            break
    return high


def finger_rows() -> Iterator[Row]:
    """Yield stiffness, torque and blocked force of the shipped finger."""
    definition = scene_from_file("scene.yaml").manipulators[0].compiled.definition
    for axis, wanted in enumerate(WANTED):
        known = moment_arms.of_definition(definition, 0, axis)
        own = definition.actuators[0].joints[axis].stiffness
        what = "the shipped finger's joint stiffness [N·m/rad]"
        reported = known.stiffness(wanted)
        yield Row(what, f"axis {axis}", "2 x 5 joints", own, reported, abs(own / reported - 1))
    grasping = moment_arms.of_definition(definition, 0, 0)
    found = blocked_equilibrium(definition, 0, 0, grasping, FORCE)
    assert found is not None
    torques = {
        "equilibrium": found.torque,
        "small angles": grasping.torque(FORCE),
        "SoMo's: F L": grasping.somo_torque(FORCE),
    }
    for name, torque in torques.items():
        force = blocked_force(torque)
        what = f"blocked force with the torque for {FORCE} N [N]"
        case = f"{name}, {torque:.4f} N·m"
        yield Row(what, case, "simulated", force, FORCE, abs(force / FORCE - 1))
    force = blocked_force(0.0, by_pressure=True)
    what = "blocked force of the shipped finger at 100 kPa [N]"
    yield Row(what, "by pressure", "simulated", force, FORCE, abs(force / FORCE - 1))


def rows() -> Iterator[Row]:
    """Yield every row about calibrated chains."""
    yield from tip_stiffness()
    yield from along_the_length()
    yield from large()
    yield from finger_rows()
