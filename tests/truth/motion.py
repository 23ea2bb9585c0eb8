"""Motion: frequencies of a beam, transients, a pendulum, and what no motion may change."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence

import numpy as np
from scipy.special import ellipk

from somo_cli.analysis import closed_forms
from somo_cli.manipulator import geometry
from somo_cli.manipulator.chain import Chain
from somo_cli.manipulator.kinematics import Pose
from somo_cli.scene.model import Integrator, Scene
from somo_cli.simulation.dynamics.chain_dynamics import ChainDynamics
from somo_cli.simulation.dynamics.modal import natural_frequencies
from somo_cli.simulation.plan.build import make_plan
from tests.builders import fingers, momentum, pendulum, scenes
from tests.builders.runs import rows_of
from tests.builders.scenes import scene_from_file, scene_from_text
from tests.truth.table import Row, ordered

CUT = "manipulators[0].definition.actuator_definitions[0]"
STEPS = (5e-3, 2.5e-3, 1.25e-3, 6.25e-4)
# sqrt(EI / (ρ A L⁴)) of frequencies of a clamped-free beam: squares of 1.875104068711961,
# 4.694091132974175, 7.854757438237613; any book on vibration
BEAM = (3.51601526850015, 22.034491564666773, 61.697214413549105)
# The planar chain of the transient: N joints at (i - 1/2) L/N, L = 1 m, 1 kg in slender rods,
# EI = 4 N·m², each damper 2 % of critical in the first mode, straight and at rest in gravity
# across at zero. Tip along and down at 0.25, 0.5, 0.75 and 1 s by DOP853 at 1e-12 (Radau agrees
# to 1e-12).
TRANSIENT = {
    5: [
        (0.9288555713832242, -0.34078872031111784),
        (0.8550887250207055, -0.474279098236856),
        (0.9957408858908461, -0.08628340829644408),
        (0.9814924923826583, -0.17749784507817584),
    ]
}


def slender(count: int, mass: float, rigidity: float, damping: float) -> Scene:
    """Return a beam of one metre in so many joints, as thin as a line."""
    return scene_from_file(
        "cantilever_scene.yaml",
        f"{CUT}.n_segments={count}",
        f"{CUT}.link_definition.dimensions=[1e-6, 1e-6, {1 / count!r}]",
        f"{CUT}.link_definition.mass={mass / count!r}",
        f"{CUT}.joint_definitions[0].spring_stiffness={count * rigidity!r}",
        f"{CUT}.joint_definitions[0].spring_damping={damping!r}",
        "manipulators[0].loads=[]",
    )


def frequencies() -> Iterator[Row]:
    """Yield the frequencies of chains against those of a beam, then that of a run that rings."""
    counts = (5, 10, 20, 40)
    chains = {}
    for count in counts:
        chain = ChainDynamics(slender(count, 1.0, 1.0, 0.0).manipulators[0].compiled.chain)
        mass = chain.at(np.zeros(count)).joint_inertia()
        chains[count] = natural_frequencies(mass, chain.stiffness)
    for mode, exact in enumerate(BEAM):
        rows = [
            Row(
                "frequency of a clamped-free beam, in sqrt(EI/ρAL⁴)", f"mode {mode + 1}",
                f"{count} joints", chains[count][mode], exact, abs(chains[count][mode] / exact - 1),
            )
            for count in counts
        ]  # fmt: skip
        yield from ordered(rows, [1 / count for count in counts])
    exact = float(chains[5][0])
    rows = []
    for step in (4 * one for one in STEPS):
        found = ringing(slender(5, 1.0, 1.0, 0.0), step)
        what = "frequency that a chain of 5 joints rings at [rad/s]"
        rows.append(
            Row(what, "mode 1, by a run", f"{step:g} s", found, exact, abs(found / exact - 1))
        )
    yield from ordered(rows, STEPS)


def ringing(scene: Scene, step: float) -> float:
    """Return the frequency [rad/s] at which the first mode rings, by its zero crossings."""
    chain = ChainDynamics(scene.manipulators[0].compiled.chain)
    mass = chain.at(np.zeros(chain.count)).joint_inertia()
    squares, shapes = np.linalg.eig(np.linalg.solve(mass, np.diag(chain.stiffness)))
    shape = shapes[:, np.argmin(squares)]
    angles = tuple((1e-3 * shape / np.abs(shape).max()).tolist())
    one = dataclasses.replace(scene.manipulators[0], initial_angles=angles)
    scene = dataclasses.replace(
        scene, manipulators=(one,), time_step=step, every=1, columns=("joint_angles",)
    )
    rows = np.array(rows_of(scene, round(20 / step)))
    swing = rows[:, 1]
    places = np.flatnonzero(swing[:-1] * swing[1:] < 0)
    fractions = swing[places] / (swing[places] - swing[places + 1])
    zeros = rows[places, 0] + step * fractions
    return float(math.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0]))


def transients() -> Iterator[Row]:
    """Yield the error of the damped transient over time steps, by integrator."""
    for count, exact in TRANSIENT.items():
        chain = ChainDynamics(slender(count, 1.0, 4.0, 0.0).manipulators[0].compiled.chain)
        mass = chain.at(np.zeros(count)).joint_inertia()
        omega = float(natural_frequencies(mass, chain.stiffness)[0])
        scene = slender(count, 1.0, 4.0, 2 * 0.02 / omega * 4.0 * count)
        for integrator in ("implicit", "euler"):
            yield from ordered(_of_transient(scene, integrator, np.array(exact)), STEPS)


def _of_transient(scene: Scene, integrator: Integrator, exact: np.ndarray) -> list[Row]:
    found = []
    for step in STEPS:
        one = dataclasses.replace(
            scene, gravity=(-9.81, 0.0, 0.0), integrator=integrator, time_step=step,
            every=round(0.25 / step), columns=("tip_position",),
        )  # fmt: skip
        tips = np.array(rows_of(one, round(1 / step)))[1:, [3, 1]]
        off = float(np.linalg.norm(tips - exact, axis=1).max())
        what = f"damped transient of {len(scene.manipulators[0].compiled.chain.joints)} joints"
        found.append(
            Row(f"{what}: tip [m]", integrator, f"{step:g} s", tips[-1, 1], exact[-1, 1], off)
        )
    return found


def single_joints() -> Iterator[Row]:
    """Yield a pendulum's period over its swing, its motion over steps, and a damped hinge."""
    text = pendulum.PENDULUM.replace(
        "spring_stiffness: 50, spring_damping: 0.5", "spring_stiffness: 0"
    )
    scene = scene_from_text(
        text.replace("joint_neutral_position: 0.3", "joint_neutral_position: 0")
    )
    frequency = math.sqrt(9.81 * 0.5 / pendulum.PENDULUM_INERTIA)
    for swing in (0.1, 1.0, 2.0, 3.0):
        exact = 2 / math.pi * float(ellipk(math.sin(swing / 2) ** 2))
        found = _period(scene, swing, 1e-3) * frequency / (2 * math.pi)
        what = "period of a pendulum over that of small swings"
        yield Row(what, f"swing {swing:g} rad", "0.001 s", found, exact, abs(found / exact - 1))
    for integrator in ("implicit", "euler", "explicit"):
        errors = []
        for step in STEPS:
            rows = np.array(rows_of(pendulum.pendulum_scene(integrator, step), round(1 / step)))
            exact_angles = 0.3 + closed_forms.oscillator(
                rows[:, 0], pendulum.PENDULUM_INERTIA, 0.5, 50.0, (-0.3, 0.0)
            )
            off = float(np.abs(rows[:, 1] - exact_angles).max())
            last = float(rows[-1, 1]), float(exact_angles[-1])
            errors.append(Row("damped hinge [rad]", integrator, f"{step:g} s", *last, off))
        yield from ordered(errors, STEPS)


def _period(scene: Scene, swing: float, step: float) -> float:
    """Return the period [s] of a swing about hanging down, which is half a turn from upright."""
    one = dataclasses.replace(scene.manipulators[0], initial_angles=(math.pi - swing,))
    scene = dataclasses.replace(
        scene, manipulators=(one,), time_step=step, every=1, columns=("joint_angles",)
    )
    rows = np.array(rows_of(scene, round(12 / step)))
    angle = rows[:, 1] - math.pi
    places = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))
    zeros = rows[places, 0] - step * angle[places] / (angle[places + 1] - angle[places])
    return float(zeros[-1] - zeros[0]) / (len(zeros) - 1)


def conserved() -> Iterator[Row]:
    """Yield the drift of energy and momentum, and the fall of a centre of mass."""
    rows = []
    steps = (5e-4, 2.5e-4, 1.25e-4)
    for step in steps:
        drift, exchanged = energy_drift(step, 0.5)
        what = "energy of the undamped finger, drift over exchanged"
        rows.append(Row(what, "let go upright", f"{step:g} s", drift, 0.0, drift / exchanged))
    yield from ordered(rows, steps)
    early, late = (energy_drift(1.25e-4, time)[0] for time in (0.5, 2.0))
    yield Row(
        "drift of that energy [J]", "after 2 s and after 0.5 s", "0.000125 s", late, early, late
    )
    steps = (1e-3, 5e-4, 2.5e-4)
    for number, name in enumerate(("linear momentum", "angular momentum")):
        lost = [
            momentum.loss_of_momentum(fingers.spinning_finger(step, "implicit"))[number]
            for step in steps
        ]
        rows = [
            Row(
                "momentum of a free chain, share lost in half a second",
                name,
                f"{step:g} s",
                one,
                0,
                one,
            )
            for step, one in zip(steps, lost, strict=True)
        ]
        yield from ordered(rows, steps)
    rows = []
    for step in steps:
        off = fall(step)
        rows.append(Row("centre of mass in free fall [m]", "0.2 s", f"{step:g} s", off, 0.0, off))
    yield from ordered(rows, steps)


def energy_drift(step: float, time: float) -> tuple[float, float]:
    """Return the largest drift of the energy, and the most that one form of it varied [J]."""
    scene = scene_from_text(
        "manipulators: [{definition: finger.yaml}]",
        "record={columns: [energy]}",
        f"{scenes.JOINTS}[0].spring_damping=0",
        f"{scenes.JOINTS}[1].spring_damping=0",
    )
    scene = dataclasses.replace(scene, time_step=step, every=round(0.01 / step))
    energy = np.array(rows_of(scene, round(time / step)))[:, 1:]
    total = energy.sum(axis=1)
    return float(np.abs(total - total[0]).max()), float(np.ptp(energy, axis=0).max())


def fall(step: float) -> float:
    """Return how far the centre of mass of a thrown finger is from its parabola after 0.2 s [m]."""
    scene = dataclasses.replace(
        fingers.thrown_finger(step), every=round(0.2 / step), columns=("joint_angles", "base_pose")
    )
    plan = make_plan(scene)
    rows = np.array(rows_of(scene, round(0.2 / step)))
    before, after = (_centre(plan.bodies[0].chain, row[1:], plan.scale.length) for row in rows)
    velocity = momentum.velocity_of_centre(plan)
    expected = before + 0.2 * velocity + 0.5 * 0.2**2 * np.array(scene.gravity)
    return float(np.linalg.norm(after - expected))


def _centre(chain: Chain, values: Sequence[float], length: float) -> np.ndarray:
    dynamics = ChainDynamics(chain)
    count = dynamics.count
    x, y, z, qx, qy, qz, qw = values[count : count + 7]
    base = Pose((x * length, y * length, z * length),
                geometry.rotation_from_quaternion((qx, qy, qz, qw)))  # fmt: skip
    pose = dynamics.at(values[:count], base)
    centre: np.ndarray = dynamics.masses @ pose.centres / dynamics.masses.sum() / length
    return centre


def rows() -> Iterator[Row]:
    """Yield every row about motion."""
    yield from frequencies()
    yield from transients()
    yield from single_joints()
    yield from conserved()
