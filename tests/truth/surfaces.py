"""Surfaces against closed forms: rebound, spinning, rolling, directed friction, soft contact."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from somo_cli.scene.model import Scene
from tests.builders.runs import columns_of
from tests.builders.scenes import scene_from_file, scene_from_text
from tests.truth.table import Row, ordered
from tests.truth.touching import STEPS, G, last_row, with_cubes

RADIUS, MASS = 0.02, 0.01  # m, kg
BALL = {"shape_type": "sphere", "dimensions": [RADIUS], "mass": MASS, "position": [0, 0, RADIUS]}
HEIGHTS = (0.08, 0.1, 0.123)  # m
ARM = 1e-3  # m
FACTORS = (1.0, 0.2, 1.0)


def course(scene: Scene, step: float, time: float) -> dict[str, np.ndarray]:
    """Return the columns of a run, every step."""
    return columns_of(dataclasses.replace(scene, time_step=step), round(time / step))


def rebound(restitution: float, step: float, height: float) -> float:
    """Return the speed after over that before the fall of a ball, by the heights."""
    ball = {**BALL, "position": [0, 0, RADIUS + height], "restitution": restitution}
    fall = math.sqrt(2 * height / G)
    found = course(with_cubes({"name": "ball", **ball}), step, (1 + 1.2 * restitution) * fall)
    gap = found["ball.pose.z_m"] - RADIUS
    return math.sqrt(max(0.0, float(gap[round(1.1 * fall / step) :].max())) / height)


def head_on(restitution: float, step: float) -> tuple[float, float]:
    """Return the speed apart over the speed together of two balls, and the change of momentum."""
    one = {**BALL, "name": "a", "position": [-0.05, 0, 1], "linear_velocity": [0.5, 0, 0]}
    two = {**BALL, "name": "b", "position": [0.05, 0, 1], "mass": 2 * MASS, "restitution": 1}
    scene = with_cubes({**one, "restitution": restitution}, two, gravity=[0, 0, 0])
    found = course(scene, step, 0.4)
    a, b = (float(np.diff(found[f"{name}.pose.x_m"])[-1]) / step for name in "ab")
    return (b - a) / 0.5, (a + 2 * b) / 0.5 - 1


def spun(step: float) -> tuple[float, float]:
    """Return the angle [rad] that a spinning ball has turned, and the closed form."""
    ball = {**BALL, "name": "ball", "angular_velocity": [0, 0, 100], "spinning_friction": ARM}
    found = course(with_cubes(ball, ground={"spinning_friction": ARM}), step, 1.2)
    half = np.arctan2(found["ball.pose.qz"], found["ball.pose.qw"])
    # arm of the contact: that of the ball, and the ground's times the ball's friction, 0.5
    slowing = 1.5 * ARM * G / (0.4 * RADIUS**2)
    return float(np.unwrap(2 * half)[-1]), 100**2 / (2 * slowing)


def rolled(step: float) -> tuple[float, float]:
    """Return the distance of a rolling ball until it stops [m], and the closed form."""
    motion = {"linear_velocity": [0.3, 0, 0], "angular_velocity": [0, 0.3 / RADIUS, 0]}
    ball = {**BALL, "name": "ball", "rolling_friction": ARM, **motion}
    # (m + I / r²) a = m g arm / r
    slowing = G * ARM / RADIUS / 1.4
    found = last_row(with_cubes(ball), step, 1.2)["ball.pose.x_m"]
    return found, 0.3**2 / (2 * slowing)


def slid(yaw: float, step: float) -> float:
    """Return how far off a cube of directed friction ends that slides askew [m]."""
    cube = {"name": "cube", "position": [0, 0, 0.02], "rpy": [0, 0, yaw]}
    motion = {"linear_velocity": [0.5, 0, 0], "anisotropic_friction": FACTORS}
    end = last_row(with_cubes({**cube, **motion}), step, 0.1)
    x, y = directed(yaw, 0.1)
    return math.hypot(end["cube.pose.x_m"] - x, end["cube.pose.y_m"] - y)


def directed(yaw: float, time: float, count: int = 4000) -> np.ndarray:
    """Return the displacement of that cube [m] by its equation of motion, to second order."""
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    factors = turn @ np.diag(FACTORS[:2]) @ turn.T
    velocity, place, step = np.array([0.5, 0.0]), np.zeros(2), time / count

    def slowed(velocity: np.ndarray) -> np.ndarray:
        speed = math.hypot(*velocity)
        return -0.5 * G * factors @ velocity / speed if speed > 1e-4 else np.zeros(2)

    for _ in range(count):
        middle = velocity + step / 2 * slowed(velocity)
        velocity = velocity + step * slowed(middle)
        place = place + step * middle
    return place


def sunk(step: float, stiffness: float) -> float:
    """Return how deep a ball rests in the ground, over m g / k."""
    ball = {**BALL, "name": "ball", "contact_stiffness": stiffness, "contact_damping": 1}
    depth = RADIUS - last_row(with_cubes(ball), step, 1.0)["ball.pose.z_m"]
    return depth * stiffness / (MASS * G)


def most_energy(step: float, restitution: float) -> float:
    """Return the most energy a tumbling cube ever has, over that at the start."""
    cube: dict[str, Any] = {"name": "cube", "position": [0, 0, 0.1], "rpy": [0.3, 0.4, 0]}
    found = course(with_cubes({**cube, "restitution": restitution}), step, 1.5)
    place = np.array([found[f"cube.pose.{axis}_m"] for axis in "xyz"])
    turn = np.array([found[f"cube.pose.q{axis}"] for axis in "xyzw"])
    velocity = np.diff(place) / step
    # the angle between two orientations: 2 acos |q · p|, by the chord, which rounds better
    same = np.sign((turn[:, 1:] * turn[:, :-1]).sum(axis=0))
    chord = np.linalg.norm(turn[:, 1:] - same * turn[:, :-1], axis=0)
    spin = 4 * np.arcsin(np.minimum(1, chord / 2)) / step
    inertia = 0.01 * 0.04**2 / 6
    height = (place[2, 1:] + place[2, :-1]) / 2 - 0.02
    energy = 0.01 * (G * height + (velocity**2).sum(axis=0) / 2) + inertia * spin**2 / 2
    return float(energy.max() / energy[0])


def rows() -> Iterator[Row]:
    """Yield every row about surfaces."""
    yield from _impacts()
    yield from _rubbing()
    what = "depth of a resting ball, over m g / k: relative error"
    for stiffness in (100.0, 1000.0):
        for step in STEPS:
            found = sunk(step, stiffness)
            yield Row(what, f"{stiffness:g} N/m", f"{step:g} s", found, 1, abs(found - 1))


def _impacts() -> Iterator[Row]:
    what = "speed of a falling ball after over before the impact: largest error of three heights"
    for wanted in (0.3, 0.5, 0.9, 1.0):
        for step in STEPS:
            each = [rebound(wanted, step, height) for height in HEIGHTS]
            worst = max(each, key=lambda one: abs(one - wanted))
            case = f"restitution {wanted:g}"
            yield Row(what, case, f"{step:g} s", worst, wanted, abs(worst - wanted))
    what = "two balls head-on: speed apart over speed together"
    for wanted in (0.0, 0.5, 1.0):
        for step in STEPS:
            found, _ = head_on(wanted, step)
            case = f"restitution {wanted:g}"
            yield Row(what, case, f"{step:g} s", found, wanted, abs(found - wanted))
    what = "two balls head-on: change of momentum, relative"
    for step in STEPS:
        _, change = head_on(0.5, step)
        yield Row(what, "restitution 0.5", f"{step:g} s", 1 + change, 1, abs(change))
    what = "most energy of a cube that falls on its corner, over that at the start: what is gained"
    for restitution in (0.3, 0.5, 0.7, 0.9, 1.0):
        for step in STEPS:
            found = most_energy(step, restitution)
            case = f"restitution {restitution:g}"
            yield Row(what, case, f"{step:g} s", found, 1, max(0.0, found - 1))


def _rubbing() -> Iterator[Row]:
    what = "angle a spinning ball turns until spinning friction stops it [rad], relative error"
    for step in STEPS:
        found, wanted = spun(step)
        yield Row(what, "100 rad/s", f"{step:g} s", found, wanted, abs(found / wanted - 1))
    what = "distance of a ball until rolling friction stops it [m], relative error"
    for step in STEPS:
        found, wanted = rolled(step)
        yield Row(what, "0.3 m/s", f"{step:g} s", found, wanted, abs(found / wanted - 1))
    what = "displacement of a cube of directed friction, factors 1 and 0.2 [m]: error"
    for degrees in (0, 20, 45, 90):
        yaw = math.radians(degrees)
        length = float(np.linalg.norm(directed(yaw, 0.1)))
        steps = STEPS[::-1]
        found = [slid(yaw, step) for step in steps]
        yield from ordered(
            [
                Row(what, f"{degrees} degrees", f"{step:g} s", length, length, off)
                for step, off in zip(steps, found, strict=True)
            ],
            steps,
        )
    yield from _crawling()
    yield from _impacts_of_a_chain()


def crawled(step: float, time: float, *sets: str) -> float:
    """Return how far the middle between base and tip of the crawler has gone [m]."""
    end = course(scene_from_file("crawler_scene.yaml", *sets), step, time)
    path = [(end[f"{place}.{axis}_m"][[0, -1]]) for axis in "xy" for place in PLACES]
    x, y = ((path[n] + path[n + 1]) / 2 for n in (0, 2))
    return math.hypot(x[1] - x[0], y[1] - y[0])


PLACES = ("crawler.base_pose", "crawler.tip")


def _crawling() -> Iterator[Row]:
    what = "displacement of the crawling snake in 2 s [m], relative to the finest step"
    found = [crawled(step, 2) for step in STEPS]
    for step, path in zip(STEPS, found, strict=True):
        off = abs(path / found[0] - 1)
        yield Row(what, "crawler_scene.yaml", f"{step:g} s", path, found[0], off)
    what = "the same with equal factors [m]"
    path = crawled(1e-3, 2, "manipulators[0].surface.anisotropic_friction=[1, 1, 1]")
    yield Row(what, "crawler_scene.yaml", "0.001 s", path, 0, path)


def most_gained(step: float, integrator: str, restitution: float) -> float:
    """Return the largest rise of a falling finger's energy, over what it had at the start."""
    one = {
        "definition": "planar_finger.yaml",
        "base": "free",
        "position": [0, 0, 0.25],
        "rpy": [0.4, 0.9, 0],
        "surface": {"restitution": restitution},
    }
    record = {"columns": ["energy"]}
    scene = {"ground": {}, "integrator": integrator, "manipulators": [one], "record": record}
    found = course(scene_from_text(json.dumps(scene)), step, 0.6)
    energy = np.sum([column for name, column in found.items() if ".energy." in name], axis=0)
    return float((energy - np.minimum.accumulate(energy)).max() / energy[0])


def _impacts_of_a_chain() -> Iterator[Row]:
    what = "largest rise of the energy of a finger that falls on the ground, over that at the start"
    for integrator, steps in (("explicit", (5e-5,)), ("euler", (1e-3,)), ("implicit", STEPS[:3])):
        for restitution in (0.0, 0.5, 0.9):
            for step in steps:
                found = most_gained(step, integrator, restitution)
                case = f"{integrator}, restitution {restitution:g}"
                yield Row(what, case, f"{step:g} s", found, 0, found)
