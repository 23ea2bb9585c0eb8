"""What the hand of in_hand_scene.yaml does with its cube: runs, and the numbers of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from somo_cli.arrays import Array
from tests.studies.running import Record, Setting, recorded_all

SCENE = "in_hand_scene.yaml"
PREFIX, CYCLE, CYCLES = 2.0, 8.0, 10  # s, s
SECONDS = PREFIX + CYCLES * CYCLE + 2  # with what comes after
STEP = 2e-3  # s: of most runs; that of the scene is half as long
FINGERS = tuple(f"manipulators[{number}]" for number in range(4))
# the cube on the palm itself, the pads out of the way
FLAT_PALM = (
    "objects[0].position=[0, 0, 0.08]",
    "objects[1].place={on: palm}",
    *(f"objects[{number}].position=[0, {0.1 * number!r}, -1]" for number in (2, 3, 4, 5)),
)


@dataclass(frozen=True, slots=True)
class Turn:
    """The cube over time [s]: how far it has turned about z [°], its place [m], its tilt [°]."""

    times: Array
    yaw: Array
    places: Array  # (n, 3)
    tilt: Array

    @property
    def ends(self) -> Array:
        """How far it has turned at the start of the first cycle and the end of each [°].

        Of those that the run reaches.
        """
        count = int((self.times[-1] - PREFIX + 1e-9) / CYCLE)
        ends: Array = np.interp(PREFIX + CYCLE * np.arange(count + 1), self.times, self.yaw)
        return ends

    @property
    def cycles(self) -> Array:
        """How far it turns in each cycle [°]."""
        cycles: Array = np.diff(self.ends)
        return cycles

    @property
    def per_cycle(self) -> float:
        """How far it turns in a cycle, mean over all [°]; 0 if it was lost in the first."""
        return float(self.cycles.mean()) if len(self.cycles) else 0.0

    @property
    def drift(self) -> float:
        """Return how far its centre gets off the hand's axis [m]."""
        return float(np.linalg.norm(self.places[:, :2], axis=1).max())

    @property
    def rise(self) -> float:
        """Return how far its centre gets above where it started [m]."""
        return float((self.places[:, 2] - self.places[0, 2]).max())


def turn(record: Record) -> Turn:
    """Return what a record says of the cube."""
    places = np.transpose([record[f"cube.pose.{axis}_m"] for axis in "xyz"])
    # the angle between the cube's z axis and the world's: cos = 1 - 2 (qx² + qy²)
    across = np.hypot(record["cube.pose.qx"], record["cube.pose.qy"])
    tilt = np.degrees(2 * np.arcsin(np.minimum(across, 1)))
    return Turn(record["time_s"], np.degrees(record["cube.angles.z_rad"]), places, tilt)


def turns(settings: Sequence[Setting], processes: int | None = None) -> list[Turn]:
    """Run settings side by side."""
    return [turn(record) for record in recorded_all(settings, processes)]


def setting(*sets: str, cycles: int = CYCLES, time_step: float = STEP) -> Setting:
    """Return the scene for so many cycles, the whole of it by default."""
    seconds = SECONDS if cycles == CYCLES else PREFIX + cycles * CYCLE
    return Setting(SCENE, seconds, sets, time_step)


def moved(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> tuple[str, ...]:
    """Return what moves [m] and turns [rad] the cube at the start."""
    return f"objects[1].position=[{x!r}, {y!r}, 0]", f"objects[1].rpy=[0, 0, {yaw!r}]"


def joint(axis: int, field: str, value: float) -> tuple[str, ...]:
    """Return what changes a field of the joints about an axis of all fingers."""
    where = f"definition.actuator_definitions[0].joint_definitions[{axis}].{field}"
    return tuple(f"{finger}.{where}={value!r}" for finger in FINGERS)
