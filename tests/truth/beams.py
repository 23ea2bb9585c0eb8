"""Beams at rest: the chain against the continuum, and the run against the chain.

Forces on the tip and own weight are dead loads, applied to the shipped cantilever (EI = 1 N·m²,
L = 1 m) cut into more and more joints, in runs that last until it has come to rest.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence

import numpy as np

from somo_cli.analysis import closed_forms, scene_variants
from somo_cli.scene.model import Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.external_loads import generalised_load_force, load_stiffness
from somo_cli.simulation.plan.build import make_plan
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file
from tests.truth.table import Row, ordered

JOINTS = (5, 10, 20, 40)
STEP, REST = 2e-2, 12.0  # s
# Mattiasson, Int. J. Numer. Meth. Eng. 17 (1981) 145, table 1: sideways and shortening over L
FORCES = {0.2: (0.06636, 0.00265), 1: (0.30172, 0.05643), 2: (0.49346, 0.16064),
          5: (0.71379, 0.38763), 10: (0.81061, 0.55500)}  # fmt: skip
# Shooting with DOP853 to 1e-13: x/L and y/L under w L³/EI
WEIGHTS = {
    0.1: (0.999910732224, 0.012498437848),
    1: (0.991246395347, 0.123471401983),
    2: (0.966892946896, 0.238506582873),
    5: (0.846657179954, 0.495905044622),
    10: (0.656353761239, 0.700199715514),
    20: (0.445232052240, 0.829881443439),
}
MOMENTS = {"0.5": 0.5, "pi/2": math.pi / 2, "pi": math.pi, "2 pi": 2 * math.pi}


def cantilever(count: int, *sets: str) -> Scene:
    """Return the shipped cantilever in so many joints, recording its end alone."""
    scene = scene_variants.with_segments(scene_from_file("cantilever_scene.yaml", *sets), count)
    return dataclasses.replace(
        scene,
        time_step=STEP,
        every=round(REST / STEP),
        columns=("tip_position", "joint_angles"),
    )


def under_force(count: int, load: float) -> Scene:
    """Return the cantilever under a force of P L²/EI = load on its tip."""
    ramp = "waypoints: [[0, 0], [1, 1]], interpolation: cubic"
    loads = f"[{{link: tip, force: [{load}, 0, 0], {ramp}}}]"
    return cantilever(count, f"manipulators[0].loads={loads}")


def under_weight(count: int, load: float) -> Scene:
    """Return the cantilever under its own weight w L³/EI = load, along x."""
    return cantilever(count, "manipulators[0].loads=[]", f"gravity=[{load / 0.3!r}, 0, 0]")


def under_moment(count: int, moment: float) -> Scene:
    """Return the cantilever under an end moment M L/EI, about y."""
    ramp = "waypoints: [[0, 0], [2, 1]], interpolation: cubic"
    return cantilever(count, f"manipulators[0].loads=[{{moment: [0, {moment!r}, 0], {ramp}}}]")


def at_rest(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return tip [m], along and sideways, and joint angles [rad] at the end of a run."""
    row = np.array(rows_of(scene, round(REST / STEP)))[-1]
    return row[[3, 1]], row[4:]


def equilibrium(scene: Scene) -> np.ndarray:
    """Return the angles at which springs, gravity and loads balance in the chain, by Newton."""
    plan = make_plan(scene)
    body = plan.bodies[0]
    chain = ChainDynamics(body.chain)
    angles = np.zeros(chain.count)
    # in small parts of the load, so that Newton stays with the one that is reached from rest
    for part in np.linspace(0.05, 1, 20):
        for _ in range(20):
            pose = chain.at(angles)
            force = pose.gravity_force((part * plan.gravity[0], 0.0, 0.0))[6:]
            matrix = np.diag(chain.stiffness) + part * pose.gravity_stiffness(plan.gravity)
            for load in body.loads:
                force = force + part * generalised_load_force(load, pose)[6:]
                matrix += load_stiffness(load, pose, part)
            change = np.linalg.solve(matrix, force - chain.stiffness * angles)
            angles = angles + change
            if np.abs(change).max() < 1e-14:
                break
    return angles


def against_beam(
    what: str, case: str, scenes: Sequence[Scene], tip: closed_forms.Tip
) -> Iterator[Row]:
    """Yield how far the tip is from that of the beam, then how far the run is from the chain."""
    rows, solver = [], 0.0
    for count, scene in zip(JOINTS, scenes, strict=True):
        found, angles = at_rest(scene)
        solver = max(solver, float(np.abs(angles - equilibrium(scene)).max()))
        off = float(np.linalg.norm(found - tip))
        rows.append(Row(what, case, f"{count} joints", float(found[1]), tip[1], off))
    yield from ordered(rows, [1 / count for count in JOINTS])
    yield Row(what, case, "solver, rad", solver, 0.0, solver)


def rows(joints: Sequence[int] = JOINTS) -> Iterator[Row]:
    """Yield every row about beams at rest."""
    for load, (sideways, shortening) in FORCES.items():
        tip = closed_forms.tip_load(load)
        off = math.dist(tip, (1 - shortening, sideways))
        yield Row(
            "elastica against Mattiasson's table", f"P L²/EI = {load}", "", tip[1], sideways, off
        )
    for load in FORCES:
        scenes = [under_force(count, load) for count in joints]
        what = "tip under a force, sideways [m]"
        yield from against_beam(what, f"P L²/EI = {load}", scenes, closed_forms.tip_load(load))
    for load, tip in WEIGHTS.items():
        scenes = [under_weight(count, load) for count in joints]
        yield from against_beam(
            "tip under own weight, sideways [m]", f"w L³/EI = {load}", scenes, tip
        )
    for name, moment in MOMENTS.items():
        scenes = [under_moment(count, moment) for count in joints]
        what = "tip under an end moment, sideways [m]"
        yield from against_beam(what, f"M L/EI = {name}", scenes, closed_forms.end_moment(moment))
