"""Parameters that a fit finds again in what a scene with known ones has recorded."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from somo_cli.calibration.fit import NothingToFit
from somo_cli.calibration.fit_diagnostics import fit_diagnostics
from somo_cli.calibration.parameters import PARAMETER_KINDS, parameters, with_factors
from somo_cli.scene.actuation import WaypointProfile
from tests.truth.fitted import (
    GUESS,
    TIP,
    TRUTH,
    driven_finger,
    fitted,
    halves,
    noisy,
    noisy_table,
    relative_errors,
)

pytestmark = pytest.mark.slow


def test_a_fit_recovers_stiffness_damping_and_gain() -> None:
    pytest.importorskip("pybullet")
    whole, *half = halves(noisy()).values()
    found, measured = fitted(driven_finger(**GUESS), whole)
    assert len(found.parameters) == 6
    assert max(map(abs, relative_errors(found).values())) < 0.01
    assert found.residual_rms == pytest.approx(1e-4, rel=0.2)
    assert found.first_residual_rms.max() > 1e-2
    truth = np.array([TRUTH[one.kind][one.axis] for one in found.parameters])
    assert (np.abs(found.values - truth) < 2 * found.errors).all()
    assert list(fit_diagnostics(found, measured.scatter)) == []
    # and from half of the data to three per cent
    for text in half:
        again, _ = fitted(driven_finger(**GUESS), text)
        assert max(map(abs, relative_errors(again).values())) < 0.03


def test_the_intervals_hold_the_truth_as_often_as_they_say() -> None:
    pytest.importorskip("pybullet")
    exact = driven_finger()
    hits, draws = 0, 15
    for seed in range(draws):
        text = noisy_table(exact, 300, TIP[:2], noise=3e-4, seed=seed)
        found, _ = fitted(exact, text, ("stiffness",))
        hits += int((np.abs(found.values - (0.1, 0.3)) < found.errors).sum())
    assert hits >= 0.83 * 2 * draws
    assert hits < 2 * draws  # wide enough to be always right would be too wide


def test_angles_and_positions_are_weighed_by_their_scatter() -> None:
    pytest.importorskip("pybullet")
    scene = driven_finger()
    names = (*TIP, "actuator_0_joint_01.angle_rad", "actuator_0_joint_04.angle_rad")
    text = noisy_table(scene, 600, names, noise=1e-4)
    found, measured = fitted(driven_finger(stiffness=(0.13, 0.25)), text, ("stiffness",))
    assert measured.quantities == ("joint_angles", "tip_position")
    assert found.values == pytest.approx([0.1, 0.3], rel=0.002)


def test_slow_motion_does_not_distinguish_stiffness_from_gain() -> None:
    pytest.importorskip("pybullet")
    # twenty times slower than the pulses, and damped so that nothing swings
    slow = {"gravity": [0, 0, 0], "time_step": 1e-2, "stretch": 20}
    scene = driven_finger(damping=(4e-3, 12e-3), **slow)
    text = noisy_table(scene, 800, TIP, noise=5e-4)
    found, measured = fitted(scene, text, ("stiffness", "gain"))
    said = list(fit_diagnostics(found, measured.scatter))
    assert any(
        "do not distinguish the stiffness of actuator 0, axis 0 from the gain of actuator 0" in one
        for one in said
    )
    alone, measured = fitted(scene, text, ("stiffness",))
    assert list(fit_diagnostics(alone, measured.scatter)) == []


def test_a_parameter_without_effect_keeps_its_guess() -> None:
    pytest.importorskip("pybullet")
    still = driven_finger(gravity=[0, 0, 0])
    one = still.manipulators[0]
    entry = one.actuation[0]
    half = dataclasses.replace(still, manipulators=(dataclasses.replace(one, actuation=(entry,)),))
    text = noisy_table(half, 400, TIP[1:], noise=1e-4)
    found, measured = fitted(half, text, ("stiffness",))
    assert [one.name for one in found.insensitive] == ["stiffness of actuator 0, axis 1"]
    assert next(fit_diagnostics(found, measured.scatter)) == (
        "the data do not depend on the stiffness of actuator 0, axis 1, which stays at 0.3"
    )
    nowhere = noisy_table(half, 200, ("tip.x_m",), noise=1e-4)
    with pytest.raises(NothingToFit, match="depends on the parameters"):
        fitted(half, nowhere, ("stiffness",))


def test_a_model_that_does_not_follow_is_reported() -> None:
    pytest.importorskip("pybullet")
    text = noisy_table(driven_finger(gravity=[3, 0, -9.81]), 500, TIP, noise=1e-4)
    found, measured = fitted(driven_finger(), text, ("stiffness",))
    assert found.autocorrelation > 0.9
    assert "the residuals are not noise" in list(fit_diagnostics(found, measured.scatter))[-1]


def test_times_may_lie_between_the_steps() -> None:
    pytest.importorskip("pybullet")
    exact = noisy_table(driven_finger(record={"every": 1}), 400, TIP)
    header, *rows = exact.split("\n")
    times = [float(row.split(",")[0]) for row in rows]
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    asked = np.array(times[3:-3:7]) + 0.37e-3
    between = [np.interp(asked, table[:, 0], table[:, column]) for column in (1, 2, 3)]
    lines = [",".join(map(repr, map(float, row))) for row in zip(asked, *between, strict=True)]
    found, _ = fitted(
        driven_finger(stiffness=(0.12, 0.3)), "\n".join([header, *lines]), ("stiffness",)
    )
    # what was asked for was read off straight lines between steps of 1 ms
    assert found.values == pytest.approx([0.1, 0.3], rel=1e-4)


def test_parameters_start_at_what_the_scene_says() -> None:
    known = list(parameters(driven_finger().manipulators[0], PARAMETER_KINDS))
    assert [(one.kind, one.axis, one.guess) for one in known] == [
        ("stiffness", 0, 0.1),
        ("damping", 0, 4e-4),
        ("gain", 0, 1.0),
        ("stiffness", 1, 0.3),
        ("damping", 1, 6e-4),
        ("gain", 1, 1.0),
    ]
    undamped = driven_finger(damping=(0, 6e-4)).manipulators[0]
    assert [one.axis for one in parameters(undamped, ("damping",))] == [1]


def test_changed_scenes_have_their_factors() -> None:
    scene = driven_finger()
    known = list(parameters(scene.manipulators[0], PARAMETER_KINDS))
    (one,) = with_factors(scene, known, [np.log(2), 0, 0.5, 0, np.log(3), 0]).manipulators
    first, second = one.compiled.chain.joints[:2]
    assert (first.stiffness, first.damping) == pytest.approx((0.2, 4e-4))
    assert (second.stiffness, second.damping) == pytest.approx((0.3, 18e-4))
    profile = one.actuation[0].profile
    assert isinstance(profile, WaypointProfile)
    assert profile.points[1] == (0.02, pytest.approx(0.018))
    assert one.actuation[1] == scene.manipulators[0].actuation[1]
