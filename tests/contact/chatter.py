"""A finger whose dampers outweigh its inertia, its tip sliding on the ground: how much it shakes.

Where B is far above M the law lets the measured force decide nearly all of the next step's, so that
what friction does comes back a step later.
"""

from __future__ import annotations

import dataclasses
import json
import math

import numpy as np

from somo_cli.analysis.recorded_run import record_rows
from somo_cli.problems import SimulationDiverged
from somo_cli.simulation.engine.bullet.world import BulletWorld
from somo_cli.simulation.plan.build import make_plan
from tests.builders.scenes import scene_from_text
from tests.contact.candidates import Candidate
from tests.contact.cases import dragged

DAMPERS = (1, 30, 300)  # times the shipped finger's
STEPS = (2e-3, 1e-3, 5e-4)  # s
SECONDS = 0.5


def shake(candidate: Candidate, dampers: float, step: float) -> float:
    """Return by how much [rad] a joint departs from the mean of the steps before and after.

    The most of any joint in the second half; the torque is larger for the larger dampers.
    """
    data = dragged().data
    data["manipulators"][0]["surface"] = {"friction": 0.5}  # with more it sticks
    data["manipulators"][0]["actuation"][0]["waypoints"] = [[0, 0.04 * max(1, dampers / 30)]]
    joint = "manipulators[0].definition.actuator_definitions[0].joint_definitions"
    sets = [
        f"{joint}[{index}].spring_damping={damping * dampers}"
        for index, damping in enumerate((0.00045, 0.00072))
    ]
    scene = dataclasses.replace(
        scene_from_text(json.dumps(data), *sets),
        integrator=candidate.integrator,
        time_step=step,
        every=1,
        columns=("joint_angles",),
    )
    plan = make_plan(scene)
    try:
        with candidate.installed():
            angles = record_rows(plan, round(SECONDS / step), BulletWorld)[:, 1:]
    except SimulationDiverged:
        return math.nan
    bent = angles[2:] - 2 * angles[1:-1] + angles[:-2]
    return float(np.abs(bent[len(bent) // 2 :]).max() / 2)
