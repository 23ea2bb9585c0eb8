"""The grasp of a ball in MuJoCo, at the same steps.

Of the contacts that were tried at 0.25 to 2 ms (as stiff as two steps allow or its default
softness; friction as stiff as the normal force, or 10 or 100 times) the default softness with 10 is
the best: with most others the ball slips up between the fingers. At 0.1 ms the stiffest holds it
where our converged run does, to 0.1 mm.
"""

from __future__ import annotations

import mujoco
import numpy as np

from tests.contact.second_opinion import drives_of, model_of
from tests.grasp.cases import END, RADIUS, Grasp
from tests.grasp.trial import QUIET, Held

SOFT = (0.02, 1.0)  # s, damping ratio: MuJoCo's default
IMPEDANCE = (0.9, 0.95, 0.001, 0.5, 2.0)  # its default as well
FRICTION_STIFFNESS = 10


def held_in_mujoco(grasp: Grasp, step: float) -> Held:
    """Return how an object is held in the end by fingers whose bases do not move."""
    scene = grasp.scene(step)
    model = model_of(scene, step)
    model.geom_solref[:], model.geom_solimp[:] = SOFT, IMPEDANCE
    model.opt.impratio = FRICTION_STIFFNESS
    state = mujoco.MjData(model)
    drives = drives_of(model, scene)
    thing = model.body("object").id
    # on the ground, where the plan puts it
    state.qpos[model.jnt_qposadr[model.body_jntadr[thing]] + 2] = RADIUS
    forces: list[float] = []
    steps = round(END / step)
    for number in range(steps):
        for signal, dofs in drives:
            state.qfrc_applied[dofs] = signal.at((number + 0.5) * step)
        mujoco.mj_step(model, state)
        if number * step > END - QUIET:
            forces.append(_normal_force(model, state, thing))
    return Held(float(np.mean(forces)), float(np.std(forces)), state.xpos[thing].copy(), 0.0)


def _normal_force(model: mujoco.MjModel, state: mujoco.MjData, body: int) -> float:
    """Return the sum of the normal forces on a body in the last step."""
    total, force = 0.0, np.zeros(6)
    for index in range(state.ncon):
        if body in model.geom_bodyid[state.contact.geom[index]]:
            mujoco.mj_contactForce(model, state, index, force)
            total += float(force[0])
    return total
