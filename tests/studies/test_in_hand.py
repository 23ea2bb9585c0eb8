"""The hand grips and turns its cube; the grip is sharp, the turn within its spread."""

from __future__ import annotations

import numpy as np
import pytest

from tests.studies.in_hand import apart
from tests.studies.in_hand_open import FACTORS
from tests.studies.in_hand_turn import FLAT_PALM, PREFIX, SCENE, Turn, moved, setting, turn, turns
from tests.studies.running import Record, Setting, recorded

pytest.importorskip("pybullet")

GRIP = "record={every: 500, columns: [tip_position], objects: [pose, contact_pairs]}"


def grip(*sets: str, time_step: float = 1e-3) -> dict[str, float]:
    """Return what the cube feels after the prefix [N], by column, and its height [m]."""
    record = recorded(Setting(SCENE, PREFIX, (GRIP, *sets), time_step))
    return {name: float(values[-1]) for name, values in record.columns.items()}


def on_pads(found: dict[str, float]) -> float:
    """Return the normal force on all pads [N]."""
    return sum(found[f"cube.contact.pad_{number}.normal_n"] for number in (1, 2, 3, 4))


@pytest.mark.moderate
@pytest.mark.parametrize(
    ("scale", "step"), [(20, 1e-3), (20, 2e-3), (20, 5e-4), (10, 1e-3), (40, 1e-3)]
)
def test_the_grip_is_the_same_at_any_step_and_scale(scale: int, step: float) -> None:
    found = grip(f"world_scale={scale}", time_step=step)
    assert found["cube.contact.finger_2.normal_n"] == pytest.approx(0.5304, rel=2e-3)
    assert on_pads(found) == pytest.approx(1.371, rel=2e-3)
    assert found["cube.pose.z_m"] == pytest.approx(0.115, abs=1e-5)
    assert found["cube.contact.finger_1.normal_n"] == found["cube.contact.palm.normal_n"] == 0


@pytest.mark.moderate
def test_fingers_that_press_slide_down_the_cube() -> None:
    """Friction is fully used before the cube turns at all."""
    found = grip()
    normal, friction, down = (
        found[f"cube.contact.finger_2.{what}_n"] for what in ("normal", "friction", "fz")
    )
    assert friction == pytest.approx(1.2 * normal, rel=1e-3)
    assert down == pytest.approx(-friction, rel=5e-3)
    # what presses the cube on the pads is the two fingers and its weight
    assert on_pads(found) == pytest.approx(0.01 * 9.81 - 2 * down, rel=1e-3)


@pytest.mark.moderate
def test_the_cube_turns_as_far_whatever_the_step_and_the_scale() -> None:
    changes = ((), 2e-3), ((), 4e-3), (moved(x=1e-6), 4e-3), (("world_scale=10",), 4e-3)
    runs = turns([Setting(SCENE, PREFIX + 2, sets, step) for sets, step in changes], processes=1)
    for run in runs:
        assert run.yaw[-1] == pytest.approx(28.1, abs=0.15)
        assert run.drift < 1e-4
        assert run.tilt.max() < 0.1
        assert abs(run.yaw[run.times <= PREFIX]).max() < 0.01
    assert apart(runs) is None


@pytest.mark.slow
@pytest.mark.parametrize(("scale", "step"), [(20, 1e-3), (10, 2e-3), (40, 2e-3)])
def test_three_cycles_turn_it_as_far(scale: int, step: float) -> None:
    (run,) = turns([setting(f"world_scale={scale}", cycles=3, time_step=step)])
    assert run.ends[-1] == pytest.approx(158.4, rel=5e-3)


@pytest.mark.slow
def test_on_a_flat_palm_a_micrometre_decides_how_far() -> None:
    """Where contact leaves undetermined what resists: the cube turns, but runs drift apart."""
    starts = (), moved(x=1e-6)
    runs = turns([setting(*FLAT_PALM, *start, cycles=1) for start in starts])
    for run in runs:
        assert 35 < run.per_cycle < 75
    when = apart(runs)
    assert when is not None
    assert PREFIX < when < 5


@pytest.mark.moderate
def test_the_same_run_gives_the_same_bytes() -> None:
    first, second = (recorded(Setting(SCENE, PREFIX + 1, (), 2e-3)) for _ in range(2))
    assert first.columns.keys() == second.columns.keys()
    assert first["cube.angles.z_rad"][-1] > 0.2
    for name, values in first.columns.items():
        assert values.tobytes() == second.columns[name].tobytes(), name


def test_cycles_are_counted_from_the_end_of_the_prefix() -> None:
    times = np.arange(0, 27, 0.1)
    run = Turn(times, 10 * (times - PREFIX), np.zeros((len(times), 3)), 0 * times)
    assert run.cycles == pytest.approx([80, 80, 80])
    assert run.per_cycle == pytest.approx(80)


@pytest.mark.slow
def test_more_torque_aside_turns_it_farther() -> None:
    weak, strong = (setting(*FACTORS["torque aside"][part], cycles=2) for part in (0.7, 1.3))
    less, more = turns([weak, strong], processes=1)
    assert 0 < less.per_cycle < 0.75 * more.per_cycle


def test_tilt_is_that_of_the_cubes_own_axis() -> None:
    half = np.radians(30) / 2
    zero = np.zeros(1)
    names = [f"cube.pose.{axis}_m" for axis in "xyz"]
    columns = dict.fromkeys(names, zero) | {
        "time_s": zero,
        "cube.pose.qx": np.array([np.sin(half)]),
        "cube.pose.qy": zero,
        "cube.angles.z_rad": zero,
    }
    assert turn(Record(columns, None)).tilt == pytest.approx([30])  # type: ignore[arg-type]
