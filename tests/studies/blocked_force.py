"""Blocked force: a finger presses on a block while its pressure rises and falls.

The force is held against the line of the calibration (small angles: force is proportional to
torque) and against the equilibrium of the pressing chain, angles of any size, which is solved for
without the engine.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.optimize import root

from somo_cli.arrays import Array
from somo_cli.calibration.moment_arms import of_definition
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from tests.builders.scenes import scene_from_file
from tests.studies import drawing
from tests.studies.running import Setting, recorded

SCENE = "blocked_force_scene.yaml"
SECONDS = 4.5
RISES, HOLDS = 2.0, 2.5  # s: until when the pressure does
SETTLED = 0.5  # s: what swings at the start has come to rest
BALL = (
    0.0,
    0.005,
    0.005,
)  # m: the centre of the ball, in the frame of the tip, beyond the actuator
BASE = 0.01  # m: height of the base
TORQUE, FORCE = "finger.actuator_0_axis_0.torque_nm", "finger.contact.block.fy_n"
PRESSURES = (2e4, 4e4, 6e4, 8e4, 1e5)  # Pa
SCALES = (10, 20, 40)
STEPS = (2e-3, 1e-3, 5e-4)  # s
ONE = "manipulators[0]"
JOINT = f"{ONE}.definition.actuator_definitions[0].joint_definitions[0]"


@dataclass(frozen=True, slots=True)
class Finger:
    """The finger of the scene without the engine: its chain, and what calibration says of it."""

    body: ChainDynamics
    drives: Array  # 1 for each joint of the grasping axis, 0 for others
    link: int  # the last one
    local: Array  # centre of the ball in its frame [m]
    torque_per_pressure: float  # N·m/Pa
    force_per_torque: float  # 1/m, by the rule of small angles, at the centre of the ball

    def equilibrium(self, torque: float, gravity: tuple[float, float, float] = (0, 0, 0)) -> float:
        """Return the force on the block [N] with this torque [N·m]: rest, the ball held in y."""
        start = self.body.at(np.zeros(self.body.count)).point(self.link, self.local)

        def unbalance(unknown: Array) -> Array:
            angles, force = unknown[:-1], unknown[-1]
            pose = self.body.at(angles)
            point = pose.point(self.link, self.local)
            pressed = pose.generalised_force(
                self.link, point, np.array((0.0, force, 0.0)), np.zeros(3)
            )
            loads = (pressed + pose.gravity_force(gravity))[6:]
            rest = torque * self.drives - self.body.stiffness * angles + loads
            return np.append(rest, point[1] - start[1])

        guess = np.append(np.zeros(self.body.count), torque * self.force_per_torque)
        found = root(unbalance, guess, method="hybr", options={"xtol": 1e-12})
        assert found.success, found.message
        return float(found.x[-1])

    def line(self, torque: float) -> float:
        """Return the force [N] by the rule of small angles."""
        return torque * self.force_per_torque


def finger(*sets: str) -> Finger:
    """Return the finger of the scene, with what is set in it."""
    compiled = scene_from_file(SCENE, *sets).manipulators[0].compiled
    chain, definition = compiled.chain, compiled.definition
    moment_arms = of_definition(definition, 0, 0)
    moment_arms = replace(moment_arms, at=chain.length - BASE + BALL[2])
    per_pressure = definition.actuators[0].joints[0].torque_per_pressure
    assert per_pressure is not None
    body = ChainDynamics(chain)
    last, tip = body.tips[-1]
    drives = np.array([float(joint.channel == 0) for joint in chain.joints])
    per_torque = 1 / moment_arms.torque(1.0)
    return Finger(body, drives, last, tip + BALL, per_pressure, per_torque)


@dataclass(frozen=True, slots=True)
class Press:
    """A run over time [s]: the force on the block [N], and the torque behind it [N·m].

    That is the torque of a step earlier: a force that is recorded is that of the step before.
    """

    times: Array
    torques: Array
    forces: Array

    def held(self) -> float:
        """Return the force at the end of the hold at 100 kPa [N]."""
        return float(np.interp(HOLDS, self.times, self.forces))

    def at(self, torque: float, falling: bool = False) -> float:
        """Return the force [N] when the torque passes this one, while it rises or falls."""
        if falling:
            part = self.times >= HOLDS
            return float(np.interp(torque, self.torques[part][::-1], self.forces[part][::-1]))
        part = self.times <= RISES
        return float(np.interp(torque, self.torques[part], self.forces[part]))


def press(*sets: str, time_step: float = 1e-3) -> Press:
    """Run the scene."""
    record = recorded(Setting(SCENE, SECONDS, sets, time_step))
    times, torques = record["time_s"], record[TORQUE]
    return Press(times, np.interp(times - time_step, times, torques), record[FORCE])


def residuals(run: Press, one: Finger) -> Array:
    """Return how far the force of a run is from the equilibrium at its pressure, row by row [N]."""
    knots = np.linspace(0, run.torques.max(), 101)
    known = np.array([one.equilibrium(float(torque)) for torque in knots])
    off: Array = run.forces - np.interp(run.torques, knots, known)
    return off


def ramp(run: Press, one: Finger) -> Iterator[str]:
    """Yield the table of force over pressure."""
    yield "pressure [kPa]  torque [N·m]  rising [N]  falling [N]  equilibrium [N]  small angles [N]"
    for pressure in PRESSURES:
        torque = pressure * one.torque_per_pressure
        up, down = (run.at(torque, falling) for falling in (False, True))
        if pressure == max(PRESSURES):
            up = down = run.held()
        forces = f"{up:12.5f}{down:13.5f}{one.equilibrium(torque):17.5f}{one.line(torque):18.5f}"
        yield f"{pressure / 1e3:14.0f}{torque:14.5f}{forces}"


def steps_and_scales(one: Finger) -> Iterator[str]:
    """Yield the table of steps and world scales."""
    truth = one.equilibrium(max(PRESSURES) * one.torque_per_pressure)
    yield "world scale  step [ms]  held force / equilibrium - 1  ramps off by [mN]  settled [mN]"
    for scale in SCALES:
        for step in STEPS:
            run = press(f"world_scale={scale}", time_step=step)
            off = run.held() / truth - 1
            apart = 1e3 * np.abs(residuals(run, one))
            settled = apart[(run.times > SETTLED) & (run.times < RISES)].max()
            yield f"{scale:11}{1e3 * step:11g}{off:30.1e}{apart.max():19.3f}{settled:14.3f}"


VARIED = {
    "joint stiffness + 10 %": (f"{JOINT}.spring_stiffness=0.1287495",),
    "joint stiffness - 10 %": (f"{JOINT}.spring_stiffness=0.1053405",),
    "torque per pressure + 10 %": (f"{JOINT}.torque_per_pressure=5.370149e-07",),
    "damping x 10": (f"{JOINT}.spring_damping=0.0045",),
    "friction 0.2 on the block": ("objects[0].friction=0.25",),
    "friction 0.8 on the block": ("objects[0].friction=1",),
    "gravity": ("gravity=[0, 0, -9.81]",),
}


def variants(base: Press) -> Iterator[str]:
    """Yield what else the force depends on."""
    plain = base.held()
    yield "changed                     held [N]  of the scene's  at 50 kPa rising, falling [N]"
    for what, sets in VARIED.items():
        run = press(*sets)
        at = 5e4 * finger(*sets).torque_per_pressure
        both = f"{run.at(at):.4f}, {run.at(at, falling=True):.4f}"
        yield f"{what:26}{run.held():10.4f}{100 * (run.held() / plain - 1):+14.2f} %  {both:>28}"


def draw(path: Path, run: Press, rough: Press, one: Finger) -> None:
    """Draw force over pressure with the line, and residuals over time."""
    figure = drawing.new_figure(8, 3.6)
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    kilopascals = 1e-3 / one.torque_per_pressure
    torques = np.linspace(0, run.torques.max(), 11)
    left.plot(torques * kilopascals, [one.line(t) for t in torques], "--", color="0.5",
              label="small angles: force in proportion")  # fmt: skip
    left.plot(rough.torques * kilopascals, rough.forces, color="tab:orange", linewidth=1,
              label="run, friction 0.8 on the block")  # fmt: skip
    left.plot(run.torques * kilopascals, run.forces, color="tab:blue", label="run, no friction")
    left.plot(torques * kilopascals, [one.equilibrium(float(t)) for t in torques], "k.",
              label="equilibrium")  # fmt: skip
    drawing.panel(left, "pressure [kPa]", "force on the block [N]")
    left.legend(fontsize=8)
    right.plot(run.times, 1e3 * residuals(run, one), color="tab:blue", linewidth=0.8)
    drawing.panel(right, "time [s]", "run less equilibrium [mN]")
    drawing.save(figure, path)


def study(pictures: Path | None) -> None:
    """Print the tables; draw the figure into a folder, if given."""
    one, run = finger(), press()
    print(f"{SCENE}, {SECONDS} s at 1 ms, world scale 20")
    print(*ramp(run, one), sep="\n")
    print(*steps_and_scales(one), sep="\n")
    print(*variants(run), sep="\n")
    if pictures is not None:
        rough = press(*VARIED["friction 0.8 on the block"])
        draw(pictures / "blocked_force.png", run, rough, one)
