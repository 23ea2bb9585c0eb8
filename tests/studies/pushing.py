"""The planar arm pushes a block to a goal, slowly or with a flick: how far, over friction."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from somo_cli.arrays import Array
from tests.studies import drawing
from tests.studies.running import Record, Setting, recorded_all

SCENE = "planar_pushing_scene.yaml"
GOAL = (0.38, 0.25)  # m
GRAVITY = 9.81  # m/s²
TORQUE = 0.9  # N·m: what the scene bends with
SLOW, FLICK = 3.0, 0.5  # s: how long the torques take to rise
SECONDS = 3.5
FRICTIONS = (0.1, 0.25, 0.5, 1.0)  # of block and ground
HALF = 0.025  # m: of the block's edge
RECORD = ("record.columns=[link_positions]", "record.objects=[pose,velocity,angles,contact_pairs]")


@dataclass(frozen=True, slots=True)
class Push:
    """What became of the block: its path (2, t) [m] and angle [rad], and how it came to rest."""

    path: Array
    angle: float
    speed: float
    """When it left the arm for good [m/s]; 0 if it still touches at the end."""
    coasted: float
    """How far it slid from there on [m]."""

    @property
    def off_goal(self) -> float:
        """How far from the goal it ends [m]."""
        return float(np.hypot(*(self.path[:, -1] - GOAL)))

    @property
    def distance(self) -> float:
        """How far from its start it ends [m]."""
        return float(np.hypot(*(self.path[:, -1] - self.path[:, 0])))


def setting(friction: float, rise: float, time_step: float, *sets: str) -> Setting:
    """Return the scene with a coefficient of block and ground, torques that rise in `rise` s."""
    entries = [
        f"manipulators[0].actuation[{number}].waypoints="
        f"[[0, 0], [{rise}, {torque}], [{SECONDS}, {torque}]]"
        for number, torque in enumerate((-TORQUE, TORQUE))
    ]
    # the coefficient is the product of both, the block's is 2
    ground = f"ground.friction={friction / 2}"
    return Setting(SCENE, SECONDS, (*RECORD, ground, *entries, *sets), time_step)


def pushed(run: Record) -> Push:
    """Return what became of the block in a run."""
    path = np.array([run["block.pose.x_m"], run["block.pose.y_m"]])
    pressed = run["block.contact.planar_arm.normal_n"]
    left = int(np.flatnonzero(pressed > 0)[-1]) + 1
    angle = float(run["block.angles.z_rad"][-1])
    if left >= len(pressed):
        return Push(path, angle, 0.0, 0.0)
    speed = np.hypot(run["block.velocity.x_m_per_s"][left], run["block.velocity.y_m_per_s"][left])
    return Push(path, angle, float(speed), float(np.hypot(*(path[:, -1] - path[:, left]))))


def study(pictures: Path | None) -> None:
    """Print where the block ends over step, scale and friction; draw its path and distances."""
    steps = {
        f"{1e3 * step:g} ms, world scale {scale}": setting(
            1.0, SLOW, step, f"world_scale={scale}", "record.every=10"
        )
        for step, scale in ((2e-3, 20), (1e-3, 20), (5e-4, 20), (1e-3, 10), (1e-3, 40))
    }
    waves = [
        setting(friction, rise, 1e-3, "record.every=5")
        for rise in (SLOW, FLICK)
        for friction in FRICTIONS
    ]
    runs = recorded_all([*steps.values(), *waves])
    found = [pushed(run) for run in runs]
    print("pushed slowly, coefficient 1   x [mm]   y [mm]  turned [rad]  from the goal [mm]")
    for name, one in zip(steps, found, strict=False):
        x, y = 1e3 * one.path[:, -1]
        print(f"{name:28}{x:9.2f}{y:9.2f}{one.angle:14.4f}{1e3 * one.off_goal:20.2f}")
    swept = found[len(steps) :]
    print(
        "\ntorque within  coefficient  distance [mm]  left with [m/s]  slid on [mm]  v2 / (2 mu g)"
    )
    for number, one in enumerate(swept):
        rise, friction = (SLOW, FLICK)[number // len(FRICTIONS)], FRICTIONS[number % len(FRICTIONS)]
        wanted = one.speed**2 / (2 * friction * GRAVITY)
        print(
            f"{rise:11g} s{friction:13g}{1e3 * one.distance:15.1f}{one.speed:17.3f}"
            f"{1e3 * one.coasted:14.1f}{1e3 * wanted:15.1f}"
        )
    if pictures is not None:
        _draw(pictures, runs[1], swept)


def _draw(pictures: Path, run: Record, swept: list[Push]) -> None:
    figure = drawing.new_figure(height=3.5)
    left, right = figure.subplots(1, 2)
    frames = np.array(
        [
            [run[name] for name in run.columns if "segment" in name and name.endswith(axis)]
            for axis in (".x_m", ".y_m")
        ]
    )
    for time in (0.0, 1.5, SECONDS):
        row = int(np.argmin(np.abs(run["time_s"] - time)))
        shade = str(0.8 - 0.7 * time / SECONDS)
        left.plot(*frames[:, :, row], color=shade, linewidth=4)
        _draw_block(left, run, row, shade)
    left.plot(*GOAL, "r+", markersize=12)
    left.set_aspect("equal")
    drawing.panel(left, "x [m]", "y [m]")
    count = len(FRICTIONS)
    labels = (f"within {SLOW:g} s", f"within {FLICK:g} s")
    for label, part in zip(labels, (swept[:count], swept[count:]), strict=True):
        right.semilogx(FRICTIONS, [1e3 * one.distance for one in part], "o-", label=label)
    right.set_ylim(0)
    right.legend(fontsize=8, title="torque rises", title_fontsize=8)
    drawing.panel(right, "friction of block and ground", "distance [mm]")
    drawing.save(figure, pictures / "pushing.png")


def _draw_block(axes: Any, run: Record, row: int, shade: str) -> None:
    turn = np.exp(1j * run["block.angles.z_rad"][row])
    middle = run["block.pose.x_m"][row] + 1j * run["block.pose.y_m"][row]
    corners = middle + turn * HALF * np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j, 1 + 1j])
    axes.plot(corners.real, corners.imag, color=shade, linewidth=1.5)
