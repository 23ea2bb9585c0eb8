"""The scenes of the bench, SI, of shipped manipulators, and the figure that is asked of each."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from somo_cli.scene.model import Quantity, Scene
from tests.builders.definitions import actuator, hinge, manipulator
from tests.builders.scenes import scene_from_text

Table = Mapping[str, np.ndarray]
Data = dict[str, Any]

HANGING = math.pi  # roll of a finger that points down; positive torque about x then bends it to +y
LEVEL = math.pi / 2  # roll of one that points along -y; positive torque then bends it down
BALL = 0.015  # m: radius of the finger's tip
REACH = 0.115  # m: from the finger's base frame to the centre of that ball
ASIDE = 0.005  # m: from its axis to the centre, towards y


@dataclass(frozen=True, slots=True)
class Case:
    """A scene, how long it runs [s], and the figure that is read from its columns.

    `is_passive` says that nothing drives it: its energy can only fall. `is_slow` says that it is
    run with the laws that users can choose only.
    """

    name: str
    what: str
    data: Data
    seconds: float
    figure: Callable[[Table], float]
    columns: tuple[Quantity, ...] = ("contact_force",)
    is_passive: bool = False
    is_slow: bool = False
    finest: float = 1.25e-5  # s: the step that the explicit loop goes down to

    def scene(self, step: float) -> Scene:
        """Return the scene at a step, every row of it recorded."""
        scene = scene_from_text(json.dumps(self.data))
        return dataclasses.replace(scene, time_step=step, every=1, columns=self.columns)


def finger(name: str, torque: Any = None, **changes: Any) -> Data:
    """Return a finger of a scene, with a torque in its joints about x: constant, or waypoints."""
    data: Data = {"name": name, "definition": "finger.yaml", "surface": {"friction": 0.8}}
    if torque is not None:
        key = "waypoints" if isinstance(torque, list) else "torque"
        data["actuation"] = [{"actuator": 0, "axis": 0, key: torque}]
    return data | changes


def box(name: str, size: Sequence[float], position: Sequence[float], **changes: Any) -> Data:
    """Return a box of a scene."""
    data = {"name": name, "shape_type": "box", "dimensions": list(size)}
    return data | {"position": list(position), "friction": 1.0} | changes


def case_scene(fingers: Sequence[Data], objects: Sequence[Data] = (), **changes: Any) -> Data:
    """Return a scene that records what figures are read from."""
    record = {"objects": ["pose"] if objects else []}
    return {"manipulators": list(fingers), "objects": list(objects), "record": record} | changes


def at_end(column: str) -> Callable[[Table], float]:
    """Return the figure that is a column's last value."""
    return lambda table: float(table[column][-1])


def mean_of_last(column: str, share: float) -> Callable[[Table], float]:
    """Return the figure that is the mean of a column over the last share of the run."""

    def figure(table: Table) -> float:
        values = table[column]
        return float(values[-max(1, round(share * len(values))) :].mean())

    return figure


def impulse(column: str) -> Callable[[Table], float]:
    """Return the figure that is a force summed over the run [N s]; an impact has no other size."""

    def figure(table: Table) -> float:
        step = table["time_s"][1] - table["time_s"][0]
        return float(table[column].sum() * step)

    return figure


def wall_struck(speed: str, torque: float) -> Case:
    """A finger is bent at once and strikes a fixed wall 10 mm off; no gravity.

    Without friction, because what stuck friction holds up in the end depends on how it came to
    rest, in which two good references differ by percents.
    """
    face = ASIDE - BALL - 0.01
    wall = box("wall", [0.1, 0.02, 0.1], [0, face - 0.01, 0.1], fixed=True, friction=0)
    return Case(
        f"wall struck, {speed}",
        "impulse on the wall [N s]",
        case_scene([finger("finger", torque)], [wall], gravity=[0, 0, 0]),
        0.4,
        impulse("finger.contact.normal_n"),
    )


def block_struck(speed: str, torque: float) -> Case:
    """A finger is bent at once and strikes a block of 20 g that nothing holds; no gravity."""
    face = ASIDE - BALL - 0.01
    block = box("block", [0.04, 0.04, 0.04], [0, face - 0.02, REACH], mass=0.02, friction=0)
    return Case(
        f"block struck, {speed}",
        "path of the block [m]",
        case_scene([finger("finger", torque)], [block], gravity=[0, 0, 0]),
        0.3,
        at_end("block.pose.y_m"),
    )


def held(mass: float, count: int, torque: float) -> Case:
    """Fingers hang around a cube, close on it, and hold it when what it stands on slides away."""
    half = 0.02
    away = half + BALL + 0.002 + ASIDE
    fingers = []
    for number in range(count):
        yaw = number * 2 * math.pi / count
        place = [away * math.sin(yaw), -away * math.cos(yaw), REACH]
        fingers.append(
            finger(
                f"finger_{number}",
                [[0, 0], [0.15, torque]],
                position=place,
                rpy=[HANGING, 0, yaw],
            )
        )
    cube = box("cube", [0.04, 0.04, 0.04], [0, 0, 0], mass=mass)
    # without friction, so that it takes nothing along
    support = box("support", [0.2, 0.04, 0.02], [-0.06, 0, -half - 0.01], mass=1, friction=0)
    support["linear_velocity"] = [-0.2, 0, 0]
    return Case(
        f"cube of {1e3 * mass:g} g, {count} fingers",
        "grip force [N]",
        case_scene(fingers, [cube, support], ground={"height": -half - 0.02, "friction": 0}),
        0.8,
        mean_of_last("finger_0.contact.normal_n", 0.2),
        finest=2.5e-5,
    )


def blocked(torque: float = 0.005) -> Case:
    """A finger presses sideways on a wall that its ball touches from the start; no gravity."""
    wall = box("wall", [0.1, 0.02, 0.1], [0, ASIDE - BALL - 0.01, REACH], fixed=True, friction=0)
    return Case(
        "blocked force",
        "force on the wall [N]",
        case_scene([finger("finger", [[0, 0], [0.1, torque]])], [wall], gravity=[0, 0, 0]),
        1.5,
        at_end("finger.contact.normal_n"),
    )


def dragged() -> Case:
    """A level finger is bent to and fro, its tip on the ground."""
    torque = [[0, 0.04], [0.25, 0.04], [0.5, 0.06], [0.75, 0.04], [1, 0.06]]
    one = finger("finger", torque, position=[0, 0, 0.04], rpy=[LEVEL, 0, 0])
    return Case(
        "dragged over the ground",
        "impulse on the ground [N s]",
        case_scene([one], ground={"friction": 0.6}),
        1.0,
        impulse("finger.contact.normal_n"),
    )


def snake() -> Case:
    """The snake lies on the ground and a wave runs along it."""
    wave = {"amplitude": 0.3, "frequency": 1.0, "lag": math.pi / 4}
    one = {
        "name": "snake",
        "definition": "snake.yaml",
        "position": [-0.4, 0, 0.02],
        "rpy": [0, math.pi / 2, 0],
        "base": "free",
        "actuation": [{"actuators": "all", "axis": 0, "wave": wave}],
    }
    return Case(
        "snake on the ground",
        "how far its base got along y [m]",
        case_scene([one], ground={"friction": 0.6}),
        0.3,
        at_end("snake.base_pose.y_m"),
        finest=5e-5,  # it diverges at 2e-4
        columns=("base_pose",),
        is_slow=True,
    )


def curled() -> Case:
    """A finger of twelve joints rolls up by more than a turn, until it meets its own base."""
    link = {"shape_type": "box", "dimensions": [0.02, 0.01, 0.02], "mass": 0.01}
    joint = hinge(1, 0, 0, spring_stiffness=0.05, spring_damping=5e-4, limits=[-3, 3, 10, 10])
    one = {
        "definition": manipulator(actuator(12, joint, link=link), world_scale=20),
        "actuation": [{"actuator": 0, "axis": 0, "waypoints": [[0, 0], [0.75, 0.04]]}],
        "self_collision": True,
    }
    return Case(
        "curled onto its base",
        "how far its joints have turned together [rad]",
        case_scene([one], gravity=[0, 0, 0]),
        1.0,
        lambda table: float(
            sum(values[-1] for name, values in table.items() if name.endswith(".angle_rad"))
        ),
        columns=("joint_angles",),
        is_slow=True,
        finest=5e-5,
    )


def dropped() -> Case:
    """A finger is dropped on the ground, lying and turned a little."""
    one = finger("finger", position=[0, 0, 0.05], rpy=[LEVEL + 0.2, 0.1, 0], base="free")
    return Case(
        "finger dropped",
        "impulse on the ground [N s]",
        case_scene([one], ground={"friction": 0.6}),
        0.4,
        impulse("finger.contact.normal_n"),
        is_passive=True,
        columns=("contact_force", "energy"),
        finest=2.5e-5,
    )


def toppled() -> Case:
    """A finger that is too soft to stay level falls with its tip on ground without friction."""
    one = finger("finger", position=[0, 0, 0.035], rpy=[LEVEL, 0, 0])
    return Case(
        "finger sinks to the ground",
        "impulse on the ground [N s]",
        case_scene([one], ground={"friction": 0}),
        0.6,
        impulse("finger.contact.normal_n"),
        is_passive=True,
        columns=("contact_force", "energy"),
    )


def cases() -> tuple[Case, ...]:
    """Return every case of the bench."""
    return (
        blocked(),
        *(wall_struck(*how) for how in (("slow", 0.01), ("medium", 0.03), ("fast", 0.1))),
        *(block_struck(*how) for how in (("slow", 0.01), ("medium", 0.03), ("fast", 0.1))),
        held(0.001, 2, 0.02),
        held(0.01, 2, 0.02),
        held(0.1, 2, 0.1),
        held(0.01, 4, 0.02),
        dragged(),
        snake(),
        curled(),
        toppled(),
        dropped(),
    )


def named(name: str) -> Case:
    """Return the case of that name."""
    return next(case for case in cases() if case.name == name)
