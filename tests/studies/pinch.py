"""The pinch grasp: which blocks two fingers lift, from which height of the hand.

Over width of the block and height of the hand, for two shares of the finger that is distal; then
some of the grasps at other steps and world scales: some that are held by their faces, which agree,
and some that are not, which need not.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.studies.running import Record, Setting, recorded_all

SCENE = "pinch_scene.yaml"
SECONDS = 3.0
CLOSED = 1.495  # s: closed on the block that still stands, just before the lift
LIFTED = 0.04  # m: a block that hangs this much higher has been acquired, as in SoMo's study
DESCENT = 0.075  # m: down and up again

WIDTHS = (0.01, 0.02, 0.04, 0.06, 0.08, 0.1, 0.12)  # m
HEIGHTS = (0.13, 0.14, 0.15, 0.16, 0.175, 0.19)  # m: of the bases above the ground
DISTALS = (10, 6)  # of 20 segments

HELD = ((0.02, 0.15), (0.04, 0.15), (0.06, 0.16))  # m, width and height
TILTED = ((0.08, 0.14), (0.1, 0.15))
SHOWN = (0.06, 0.16)  # m: the grasp of the picture
VARIANTS: tuple[tuple[float, float], ...] = ((1e-3, 40), (5e-4, 40), (1e-3, 20), (1e-3, 10))


@dataclass(frozen=True, slots=True)
class Grasp:
    """What came of a grasp: how much higher the block is at the end [m], how it got there.

    `grip` is the normal force on the left finger when it has closed, `hold` at the end [N]; `tilt`
    the angle by which the block has turned [rad].
    """

    rise: float
    grip: float
    hold: float
    tilt: float

    @property
    def is_lifted(self) -> bool:
        return self.rise > LIFTED


def setting(
    width: float, height: float, distal: int = 10, step: float = 1e-3, scale: float = 40
) -> Setting:
    """Return one grasp: width of the block, height of the hand [m], distal segments of 20."""
    block = f"objects[0].dimensions[1]={width}"
    fingers = ("manipulators[0]", "manipulators[1]")
    places = (f"{finger}.position[2]={height + DESCENT}" for finger in fingers)
    cuts = (
        f"{finger}.definition.actuator_definitions[{number}].n_segments={count}"
        for finger in fingers
        for number, count in enumerate((20 - distal, distal))
    )
    return Setting(SCENE, SECONDS, (block, *places, *cuts, f"world_scale={scale}"), step)


def grasp(record: Record) -> Grasp:
    """Return what came of a run."""
    height, force = record["block.pose.z_m"], record["left.contact.normal_n"]
    closed = int((record["time_s"] < CLOSED).sum())
    upright = min(1.0, abs(record["block.pose.qw"][-1]))
    return Grasp(
        rise=float(height[-1] - height[0]),
        grip=float(force[closed]),
        hold=float(force[-1]),
        tilt=2 * math.acos(upright),
    )


def mapped(distal: int) -> dict[tuple[float, float], Grasp]:
    """Return the grasps of every height and width."""
    places = list(itertools.product(HEIGHTS, WIDTHS))
    records = recorded_all([setting(width, height, distal) for height, width in places])
    return dict(zip(places, map(grasp, records), strict=True))


def map_table(grasps: Mapping[tuple[float, float], Grasp]) -> Iterator[str]:
    """Yield how far each block has risen [mm], one line per height of the hand."""
    yield "height of hand [mm] \\ width of block [mm]: rise of the block [mm]"
    yield "      " + "".join(f"{1e3 * width:8.0f}" for width in WIDTHS)
    for height in HEIGHTS:
        rises = (grasps[height, width].rise for width in WIDTHS)
        yield f"{1e3 * height:6.0f}" + "".join(
            f"{round(1e3 * rise, 1) + 0.0:8.1f}" for rise in rises
        )


def convergence(cases: Sequence[tuple[float, float]]) -> Iterator[str]:
    """Yield each case at the steps and world scales of VARIANTS, and how far these are apart."""
    yield "width [mm], height [mm], step [ms], scale: grip [N], hold [N], rise [mm], tilt [degrees]"
    for width, height in cases:
        settings = [setting(width, height, step=step, scale=scale) for step, scale in VARIANTS]
        grasps = [grasp(record) for record in recorded_all(settings)]
        for (step, scale), one in zip(VARIANTS, grasps, strict=True):
            yield (
                f"{1e3 * width:6.0f} {1e3 * height:6.0f} {1e3 * step:6.2g} {scale:6.0f}"
                f" {one.grip:9.5f} {one.hold:9.5f} {1e3 * one.rise:8.3f}"
                f" {math.degrees(one.tilt):6.2f}"
            )
        apart = [
            spread([getattr(one, name) for one in grasps]) for name in ("grip", "hold", "rise")
        ]
        yield "       apart by" + 12 * " " + "".join(f"{100 * one:8.3f} %" for one in apart)


def spread(values: Sequence[float]) -> float:
    """Return the largest distance from the first of the values, over the first."""
    return max(abs(value / values[0] - 1) for value in values)


def study(pictures: Path | None) -> None:
    """Print the maps and the tables of convergence; draw the first map, and forces over time."""
    maps = {distal: mapped(distal) for distal in DISTALS}
    for distal, grasps in maps.items():
        lifted = sum(one.is_lifted for one in grasps.values())
        print(f"\n{distal} of 20 segments distal, {lifted} of {len(grasps)} blocks lifted")
        print(*map_table(grasps), sep="\n")
    print("\nheld by their faces")
    print(*convergence(HELD), sep="\n")
    print("\npressed upon from above at their upper edges, which makes them tilt to either side")
    print(*convergence(TILTED), sep="\n", flush=True)
    if pictures is not None:
        from tests.studies.pinch_picture import draw

        shown = recorded_all([setting(*SHOWN, step=step) for step in (1e-3, 5e-4)])
        draw(maps[DISTALS[0]], shown, pictures / "pinch.png")
