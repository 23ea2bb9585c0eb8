"""Which stiff cases survive: the finger made stiffer, cut finer, damped less, in larger steps.

Run by `make bench`. Every joint is released 0.1 rad off while a torque steps in; a case counts
as survived if one second passes without divergence.
"""

from __future__ import annotations

import dataclasses
import itertools

from somo_cli.problems import SimulationDiverged
from somo_cli.scene.actuation import Actuation, WaypointProfile
from somo_cli.scene.model import Scene
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file

JOINTS = (1, 10, 40)
STIFFER = (1.0, 1e2, 1e4, 1e6)
DAMPING = (0.002, 0.01, 0.1, None)  # s: damping over stiffness; None: that of the soft finger
STEPS = (1e-3, 5e-3, 2e-2)


def finger_scene(joints: int, stiffer: float, ratio: float | None, step: float) -> Scene:
    """Return one case."""
    actuator = "actuator_definitions[0]"
    sets = [
        f"{actuator}.n_segments={joints}",
        f"{actuator}.link_definition.dimensions[2]={0.1 / joints}",
        f"{actuator}.link_definition.mass={0.0294 / joints}",
    ]
    for index, soft in enumerate((0.117, 0.41)):
        stiffness = soft * stiffer * joints / 10
        damping = stiffness * ratio if ratio is not None else 0.01 * soft * joints / 10
        place = f"{actuator}.joint_definitions[{index}]"
        sets.append(f"{place}.spring_stiffness={stiffness}")
        sets.append(f"{place}.spring_damping={damping}")
    scene = scene_from_file("finger.yaml", *sets)
    finger = dataclasses.replace(
        scene.manipulators[0],
        initial_angles=(0.1,) * joints,
        actuation=(Actuation(0, 0, WaypointProfile(((0.0, 0.05),))),),
    )
    return dataclasses.replace(scene, manipulators=(finger,), time_step=step, every=10_000)


def survives(scene: Scene) -> bool:
    """Whether one second passes."""
    try:
        rows_of(scene, round(1 / scene.time_step))
    except SimulationDiverged:
        return False
    return True


def main() -> None:
    """Print the count for each integrator and each case that did not survive."""
    cases = list(itertools.product(JOINTS, STIFFER, DAMPING, STEPS))
    for integrator in ("implicit", "euler", "explicit"):
        failed = [
            case
            for case in cases
            if not survives(dataclasses.replace(finger_scene(*case), integrator=integrator))
        ]
        print(f"{integrator}: {len(cases) - len(failed)} of {len(cases)} stiff cases survive")
        for case in failed if len(failed) < 20 else ():
            print("  joints {}, stiffer x {:g}, d/k {} s, step {} s".format(*case))


if __name__ == "__main__":
    main()
