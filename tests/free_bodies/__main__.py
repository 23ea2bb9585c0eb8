"""Print energy, momentum and order of bodies that spin, against closed forms and MuJoCo."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from tests.free_bodies.bodies import Motion, Spinning, simulated_motion
from tests.free_bodies.cases import BALL, BODIES
from tests.free_bodies.chains import AXES, CHAINS, STIFF, chain_motion, chain_plan, spin_of
from tests.free_bodies.mujoco_body import mujoco_rotation
from tests.free_bodies.truth import orientation, symmetric_top

STEPS = (4e-3, 2e-3, 1e-3, 5e-4)  # s
LONG = 20.0  # s


def main() -> None:
    """Print two tables."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(f"free for {LONG:g} s at 1 ms: largest relative error of energy, drift of its mean")
        print("from the first to the last quarter, largest relative error of momentum")
        for body in BODIES:
            for size in (0.01, 0.03, 0.1, 0.3, 0.7, 1.0):
                fast = scaled(body, size / 1e-3)
                motion = simulated_motion(fast, folder, 1e-3, LONG, 5)
                print(f"  {body.name:22} h·omega {size:<5g} {energies(motion, fast)}")
        _print_chains()
        print("orientation after 1 s [1], largest entry, at", *(f"{step:g}" for step in STEPS), "s")
        for body in (*BODIES, BALL):
            truth = orientation(body, 1.0)
            found = [simulated_motion(body, folder, step, 1.0).rotations[-1] for step in STEPS]
            print(f"  {body.name:22} {with_orders([apart(one, truth) for one in found])}")
            if body.moments[0] == body.moments[1] and not body.rolls:
                print(f"    closed form apart by {apart(symmetric_top(body, 1.0), truth):.1e}")
            elif not body.rolls:
                print(f"    MuJoCo apart by {apart(mujoco_rotation(body, 1.0), truth):.1e}")
        for step in STEPS:
            motion = simulated_motion(BALL, folder, step, 5.0, 5)
            print(f"  {BALL.name:22} {step:g} s: {energies(motion, BALL)}")


def _print_chains() -> None:
    """Print the same of chains whose base is free, about two axes each."""
    print("chains with a free base, the same; a soft one only where its joints resolve the spin")
    for name, definition in CHAINS.items():
        for size in (0.01, 0.03, 0.1, 0.3, 1.0) if definition is STIFF else (0.01, 0.03, 0.1):
            for axis in AXES:
                motion = chain_motion(
                    chain_plan(definition, spin_of(axis, size / 1e-3), 1e-3), LONG
                )
                print(
                    f"  {name:22} h·omega {size:<5g} {motion.swing():9.1e} {motion.drift():9.1e} "
                    f"{motion.momentum_error():9.1e}"
                )


def scaled(body: Spinning, size: float) -> Spinning:
    """Return a body that spins at a rate of this size [rad/s]."""
    rate = np.array(body.rate) / np.linalg.norm(body.rate) * size
    return Spinning(body.name, body.moments, tuple(rate.tolist()), body.rolls)


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """Return the largest difference of two matrices."""
    return float(np.abs(one - other).max())


def energies(motion: Motion, body: Spinning) -> str:
    """Return errors of energy and momentum."""
    energy = motion.energies(body)
    part = len(energy) // 4
    drift = energy[-part:].mean() - energy[:part].mean()
    momentum = motion.momenta(body).max()
    return f"{np.abs(energy).max():9.1e} {drift:9.1e} {momentum:9.1e}"


def with_orders(errors: list[float]) -> str:
    """Return errors at halved steps and the orders between them."""
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    return (
        " ".join(f"{one:.2e}" for one in errors)
        + " order "
        + " ".join(f"{one:.2f}" for one in orders)
    )


if __name__ == "__main__":
    main()
