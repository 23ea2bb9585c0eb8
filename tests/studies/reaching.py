"""The planar arm reaches: where its tip comes to rest, held against statics, and how soon."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import root

from somo_cli.arrays import Array
from somo_cli.loading import load
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import compile_definition
from tests.builders.scenes import DEFINITIONS
from tests.studies import drawing
from tests.studies.running import Record, Setting, recorded_all

SCENE = "planar_reaching_scene.yaml"
PULL = 2.4525  # m/s², away from the base: what the scene says
TORQUES = (-1.5, 0.0, 1.5)  # N·m: of each actuator
REST = 20.0  # s
NEAR = 0.01  # of the length: what counts as there

Torques = Sequence[float]


@dataclass(frozen=True, slots=True)
class Reach:
    """Torques of the four actuators [N·m], and how the arm is pulled along z [m/s²]."""

    torques: tuple[float, ...]
    pull: float

    def setting(self, seconds: float, time_step: float = 4e-3, *sets: str) -> Setting:
        """Return the scene with these torques, the tip recorded 50 times a second."""
        entries = [
            f"manipulators[0].actuation[{number}].torque={torque}"
            for number, torque in enumerate(self.torques)
        ]
        gravity = f"gravity=[0, 0, {self.pull}]"
        return Setting(SCENE, seconds, (gravity, *entries, *sets), time_step)


def arm() -> Chain:
    """Return the shipped planar arm."""
    return compile_definition(load(str(DEFINITIONS / "planar_arm.yaml"))).chain


def at_rest(chain: Chain, reach: Reach) -> Array:
    """Return the tip (y, z) in equilibrium [m], by statics alone.

    Every joint: its spring's moment is its torque and that of the weight beyond it.
    """
    places = [joint.origin[2] for joint in chain.joints]
    lengths = np.array([*places, chain.length - sum(places)])
    weights = reach.pull * np.array([link.inertial.mass for link in chain.links])
    stiffness = np.array([joint.stiffness for joint in chain.joints])
    torques = np.array([reach.torques[joint.actuator] for joint in chain.joints])

    def unbalanced(angles: Array) -> Array:
        turns = np.concatenate([[0.0], np.cumsum(angles)])
        ends = np.cumsum(-lengths * np.sin(turns))
        middles = ends + 0.5 * lengths * np.sin(turns)
        beyond = [weights[n:] @ (middles[n:] - ends[n - 1]) for n in range(1, len(lengths))]
        return stiffness * angles - torques - np.array(beyond)

    found = root(unbalanced, torques / stiffness, tol=1e-12)
    turns = np.concatenate([[0.0], np.cumsum(found.x)])
    return np.array([-(lengths @ np.sin(turns)), lengths @ np.cos(turns)])


def by_hand(chain: Chain, reach: Reach) -> Array:
    """Return the tip (y, z) without gravity: all joints at torque over stiffness, in complex."""
    lengths = [joint.origin[2] for joint in chain.joints]
    turn, tip = 1 + 0j, 0j
    for joint, length in zip(chain.joints, lengths, strict=True):
        tip += length * turn
        turn *= np.exp(1j * reach.torques[joint.actuator] / joint.stiffness)
    tip += (chain.length - sum(lengths)) * turn
    return np.array([-tip.imag, tip.real])


def tip(run: Record) -> Array:
    """Return the tip over time, shape (2, t): y and z [m]."""
    return np.array([run["planar_arm.tip.y_m"], run["planar_arm.tip.z_m"]])


def settled(run: Record, place: Array, near: float) -> float:
    """Return from when on the tip stays within `near` [m] of a place [s]."""
    apart = np.hypot(*(tip(run) - place[:, None]))
    far = np.flatnonzero(apart > near)
    return float(run["time_s"][far[-1] + 1]) if len(far) else 0.0


def workspace(pull: float, seconds: float) -> list[tuple[Reach, Setting]]:
    """Return the reaches of all torques, of each pair of mirror images the first."""
    found = []
    for torques in itertools.product(TORQUES, repeat=4):
        if torques <= tuple(-one for one in torques):
            reach = Reach(torques, pull)
            found.append((reach, reach.setting(seconds)))
    return found


def study(pictures: Path | None) -> None:
    """Print errors at rest over the workspace, times, and convergence; draw the workspace."""
    chain = arm()
    drawn = {}
    print(f"{REST:g} s at 4 ms; a tip is there when it stays within {NEAR:.0%} of the length")
    print("pull [m/s2]  reaches  farthest from statics [m]  there after [s]: median, last")
    for pull in (0.0, PULL):
        reaches, settings = zip(*workspace(pull, REST), strict=True)
        runs = recorded_all(settings)
        places = [at_rest(chain, reach) for reach in reaches]
        off = [
            np.hypot(*(tip(run)[:, -1] - place)) for run, place in zip(runs, places, strict=True)
        ]
        times = [
            settled(run, place, NEAR * chain.length)
            for run, place in zip(runs, places, strict=True)
        ]
        print(f"{pull:11g}{len(runs):9}{max(off):27.1e}{np.median(times):24.2f}{max(times):6.2f}")
        drawn[pull] = np.array(places), np.array([tip(run)[:, -1] for run in runs])
    _print_convergence()
    if pictures is not None:
        _draw(pictures, drawn)


def _print_convergence() -> None:
    reach = Reach((1.5, 1.5, -1.0, -1.0), PULL)
    steps = (2.5e-4, 1e-3, 2e-3, 4e-3, 8e-3)
    cases = [reach.setting(2.0, step, "record.every=8") for step in steps]
    cases += [reach.setting(2.0, 2e-3, "record.every=8", f"world_scale={n}") for n in (10, 40)]
    finest, *runs = [tip(run) for run in recorded_all(cases)]
    print("farthest of the tip from that at 0.25 ms, within the first 2 s, of the length")
    for name, run in zip(
        ("1 ms", "2 ms", "4 ms", "8 ms", "2 ms, scale 10", "2 ms, scale 40"), runs, strict=True
    ):
        off = np.hypot(*(run - finest)).max() / 0.5
        print(f"{name:16}{off:10.1e}")


def _draw(pictures: Path, drawn: dict[float, tuple[Array, Array]]) -> None:
    figure = drawing.new_figure(height=3.5)
    for axes, (pull, (statics, runs)) in zip(figure.subplots(1, 2), drawn.items(), strict=True):
        for side in (-1, 1):
            axes.plot(side * statics[:, 0], statics[:, 1], "x", color="0.5", markersize=7)
            axes.plot(side * runs[:, 0], runs[:, 1], ".", color="tab:blue", markersize=5)
        axes.plot(0, 0, "ks")
        axes.set_aspect("equal")
        axes.set_title(f"pulled by {pull:g} m/s²", fontsize=10)
        drawing.panel(axes, "y [m]", "z [m]")
    axes.plot([], [], "x", color="0.5", label="statics")
    axes.plot([], [], ".", color="tab:blue", label="somo, 20 s")
    axes.legend(fontsize=8)
    drawing.save(figure, pictures / "reaching.png")
