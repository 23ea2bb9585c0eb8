"""The starfish shifts its weight: what each of its arms bears, and where its centre of mass is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from somo_cli.arrays import Array
from somo_cli.loading import load
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.compile import compile_definition
from somo_cli.manipulator.kinematics import Pose, link_poses
from tests.builders.scenes import DEFINITIONS
from tests.studies import drawing
from tests.studies.running import Record, Setting, recorded_all

SCENE = "starfish_shift_scene.yaml"
GRAVITY = 9.81  # m/s²
PAUSES = (0.5, 2.0, 4.5, 6.0)  # s: their ends; it stands, leans, leans back, and stands
DRY = "manipulators[0].surface.friction=1"
RECORD = (
    "record.columns=[joint_angles,tip_position,base_pose,link_contact_forces]",
    "record.every=20",
)


@dataclass(frozen=True, slots=True)
class Stand:
    """How the starfish stands, over time; loads in N, places in m, in the world."""

    times: Array
    loads: Array
    """What each arm bears, shape (5, t); the disc bears nothing but at the start."""
    on_disc: Array
    mass_centre: Array
    """Shape (3, t)."""
    pressure_centre: Array
    """Of the arms' tips, with the loads as weights: shape (2, t); nan where nothing bears."""

    def at(self, time: float) -> int:
        """Return the row of a time."""
        return int(np.argmin(np.abs(self.times - time)))


def starfish() -> Chain:
    """Return the shipped starfish."""
    return compile_definition(load(str(DEFINITIONS / "starfish.yaml"))).chain


def weight(chain: Chain) -> float:
    """Return the weight of a body [N]."""
    return GRAVITY * sum(link.inertial.mass for link in chain.links)


def setting(seconds: float, time_step: float, *sets: str) -> Setting:
    """Return the scene with all that is looked at recorded, 50 times a second at 1 ms."""
    return Setting(SCENE, seconds, (*RECORD, *sets), time_step)


def stand(run: Record, chain: Chain) -> Stand:
    """Return how it stands in a run."""
    normals = [name for name in run.columns if name.endswith(".contact.normal_n")]
    of_arm = [
        [run[name] for name in normals if f".{limb.name}_" in name] for limb in chain.backbones
    ]
    loads = np.array([np.sum(of_links, axis=0) for of_links in of_arm])
    tips = np.array(
        [[run[f"starfish.{limb.name}_tip.{axis}_m"] for axis in "xy"] for limb in chain.backbones]
    )
    every = np.sum([run[name] for name in normals], axis=0)
    with np.errstate(invalid="ignore"):
        pressure = np.einsum("at,adt->dt", loads, tips) / loads.sum(axis=0)
    return Stand(run["time_s"], loads, every - loads.sum(axis=0), mass_centre(run, chain), pressure)


def mass_centre(run: Record, chain: Chain) -> Array:
    """Return the centre of mass over time, shape (3, t) [m]."""
    angles = np.array([run[name] for name in run.columns if name.endswith(".angle_rad")])
    base = [run[f"starfish.base_pose.{part}"] for part in ("x_m", "y_m", "z_m")]
    turn = [run[f"starfish.base_pose.{part}"] for part in ("qx", "qy", "qz", "qw")]
    masses = np.array([link.inertial.mass for link in chain.links])
    centres = []
    for row in range(len(run["time_s"])):
        place = geometry.vector([of[row] for of in base])
        x, y, z, w = (float(of[row]) for of in turn)
        pose = Pose(place, geometry.rotation_from_quaternion((x, y, z, w)))
        poses = link_poses(chain, angles[:, row].tolist(), pose)
        points = [
            one.point(link.inertial.centre) for one, link in zip(poses, chain.links, strict=True)
        ]
        centres.append(masses @ np.array(points) / masses.sum())
    return np.array(centres).T


def study(pictures: Path | None) -> None:
    """Print loads and centres at the three pauses, and what steps and scales make of the shift."""
    chain = starfish()
    seconds = PAUSES[-1]
    cases = {
        "1 ms": setting(seconds, 1e-3),
        "2 ms": setting(seconds, 2e-3),
        "0.5 ms": setting(seconds, 5e-4),
        "world scale 10": setting(seconds, 1e-3, "world_scale=10"),
        "world scale 40": setting(seconds, 1e-3, "world_scale=40"),
        "dry: friction 0.8, 1 ms": setting(seconds, 1e-3, DRY),
        "dry, 2 ms": setting(seconds, 2e-3, DRY),
    }
    stands = [stand(run, chain) for run in recorded_all(list(cases.values()))]
    first = stands[0]
    print(f"at 1 ms; the starfish weighs {weight(chain):.4f} N")
    print("time [s]  load on arm 0 to 4 [N]                   sum     off  mass x [mm]  pressure x")
    for time in PAUSES:
        row = first.at(time)
        loads = first.loads[:, row]
        off = loads.sum() / weight(chain) - 1
        reported = "".join(f"{load:7.3f}" for load in loads)
        centres = 1e3 * first.mass_centre[0, row], 1e3 * first.pressure_centre[0, row]
        print(
            f"{time:8g}{reported}{loads.sum():9.4f} {off:+8.1e}{centres[0]:12.3f}{centres[1]:12.3f}"
        )
    print("where the centre of mass is at each pause, towards arm 0 [mm]")
    for name, one in zip(cases, stands, strict=True):
        places = [1e3 * one.mass_centre[0, one.at(time)] for time in PAUSES]
        print(f"{name:24}" + "".join(f"{place:9.3f}" for place in places))
    if pictures is not None:
        _draw(pictures, first)


def _draw(pictures: Path, one: Stand) -> None:
    figure = drawing.new_figure(height=3.5)
    left, right = figure.subplots(1, 2)
    labels = ("arm 0", "arms 1 and 4", "arms 2 and 3")
    for label, arms in zip(labels, ((0,), (1, 4), (2, 3)), strict=True):
        left.plot(one.times, one.loads[list(arms)].mean(axis=0), label=label, linewidth=1)
    left.set_ylim(1.3, 1.6)
    drawing.panel(left, "time [s]", "load of an arm [N]")
    left.legend(fontsize=8)
    right.plot(one.times, 1e3 * one.pressure_centre[0], color="0.7", label="of pressure")
    right.plot(one.times, 1e3 * one.mass_centre[0], color="tab:red", label="of mass")
    right.set_ylim(-8, 6)
    drawing.panel(right, "time [s]", "centre, towards arm 0 [mm]")
    right.legend(fontsize=8)
    drawing.save(figure, pictures / "starfish.png")
