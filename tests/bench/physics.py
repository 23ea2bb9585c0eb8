"""The figures behind the tests of physics: orders, scales, momentum, a thrown finger.

Run by `make bench`; the cases are those of tests/simulation/test_physics.py.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from somo_cli.manipulator.dimensions import Scale
from tests.builders import fingers, momentum, pendulum
from tests.builders.runs import rows_of


def listed(values: object) -> str:
    """Return numbers in a line."""
    return " ".join(f"{value:.3g}" for value in np.ravel(values))


def with_orders(errors: list[float]) -> str:
    """Return errors at halved steps and the orders between them."""
    return f"{listed(errors)}, orders {listed(np.log2(np.array(errors[:-1]) / errors[1:]))}"


def main() -> None:
    """Print a line for each figure."""
    steps = (2e-3, 1e-3, 5e-4)
    for integrator in ("implicit", "euler", "explicit"):
        errors = [pendulum.error_of_pendulum(integrator, step) for step in (*steps, 2.5e-4)]
        print(f"hinge, {integrator}, errors [rad] at 2e-3 ... 2.5e-4 s: {with_orders(errors)}")
    truth = fingers.struck_finger_in_mujoco()
    errors = [fingers.error_of_struck_finger(truth, step) for step in steps]
    print(f"whipped finger against MuJoCo [rad] at 2e-3, 1e-3, 5e-4 s: {with_orders(errors)}")
    rows = []
    for scale in (Scale(), Scale(20.0), Scale(8.0, 1000.0)):
        columns = ("joint_angles", "joint_rates", "spring_torques", "actuation", "tip_position")
        scene = dataclasses.replace(fingers.struck_finger(1e-3, columns=columns), scale=scale)
        rows.append(np.array(rows_of(scene, 500)))
    apart = [np.abs(other - rows[0]).max() for other in rows[1:]]
    print(f"world scales (20, 1) and (8, 1000) against (1, 1), SI: {listed(apart)}")
    for step in (1e-3, 5e-4, 2.5e-4):
        lost = momentum.loss_of_momentum(fingers.spinning_finger(step, "implicit"))
        print(f"momentum lost in half a second at {step:g} s, linear and angular: {listed(lost)}")
    apart = [fingers.error_of_thrown_finger(step) for step in steps]
    print(f"thrown finger against MuJoCo, joints [rad]: {with_orders([one[0] for one in apart])}")
    print(f"thrown finger against MuJoCo, base [m]: {with_orders([one[1] for one in apart])}")


if __name__ == "__main__":
    main()
