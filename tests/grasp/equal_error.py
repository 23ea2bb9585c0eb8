"""Grip, pose and time over steps, with and without the prediction: what equal error costs."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass

from somo_cli.scene.model import Scene
from tests.builders.scenes import scene_from_file
from tests.grasp.cases import END, RADIUS, Grasp
from tests.grasp.plain_law import without_prediction
from tests.grasp.trial import MOST_GRIP, Held, Verdict, compared, held_in

STEPS = (2.5e-4, 5e-4, 1e-3, 2e-3, 4e-3)  # s
FINE = 1e-4  # s: the step of the converged runs
HEAVY = Grasp("lifted", mass_ratio=40)


@dataclass(frozen=True, slots=True)
class Task:
    """A scene in which an object [size in m] is held until `end` [s]."""

    name: str
    scene: Callable[[float], Scene]
    thing: str
    size: float
    end: float
    is_driven: bool = False
    """Whether something moves at the end, so that the force varies as it should."""

    def run(self, step: float, predicts: bool) -> Held | None:
        """Run the task; None if it diverges."""
        with nullcontext() if predicts else without_prediction():
            return held_in(self.scene(step), self.thing, self.end)


def shipped(name: str) -> Callable[[float], Scene]:
    """Return a function that gives a shipped scene at a time step [s], a row every 2 ms."""

    def at(step: float) -> Scene:
        record = "record={columns: [contact_force], objects: [pose, contact_force]}"
        scene = scene_from_file(name, record)
        return dataclasses.replace(scene, time_step=step, every=max(1, round(2e-3 / step)))

    return at


TASKS = (
    Task("gripper: three fingers lift a ball", HEAVY.scene, "object", 2 * RADIUS, END),
    Task("pinch: two fingers lift a block", shipped("pinch_scene.yaml"), "block", 0.06, 3.2),
    Task("lift: two fingers lift a cube", shipped("lift_scene.yaml"), "cube", 0.04, 2.0),
    Task("hand: four fingers turn a cube", shipped("in_hand_scene.yaml"), "cube", 0.04, 1.6, True),
)


@dataclass(frozen=True, slots=True)
class Row:
    """A run of a task: its step [s], its errors, and time per simulated second [s/s]."""

    step: float
    errors: Verdict
    time: float

    def error(self, task: Task) -> float:
        """Return the largest of the errors of grip and pose and, where all is at rest, shaking."""
        errors = self.errors
        return max(errors.grip, errors.place, 0.0 if task.is_driven else errors.shaking)


def rows(task: Task, fine: Held, predicts: bool) -> Iterator[Row]:
    """Yield the runs of a task at all steps."""
    for step in STEPS:
        found = task.run(step, predicts)
        seconds = 0.0 if found is None else found.seconds_per_step / step
        yield Row(step, compared(fine, found, task.size), seconds)


def cheapest(task: Task, found: list[Row], error: float) -> Row | None:
    """Return the row that takes the least time for an error, None if none is so accurate."""
    good = [row for row in found if row.error(task) <= error]
    return min(good, key=lambda row: row.time, default=None)


def print_tables() -> None:
    """Print a table for each task, and what an error of 1 % and 0.1 % costs."""
    print(f"\nequal error: grip and pose against {1e3 * FINE:g} ms, with and without prediction")
    for task in TASKS:
        fine = task.run(FINE, True)
        assert fine is not None, f"{task.name} diverges at {FINE} s"
        print(f"{task.name}: {fine.force:.4f} +- {fine.deviation:.1e} N")
        of_laws = {predicts: list(rows(task, fine, predicts)) for predicts in (True, False)}
        for predicts, found in of_laws.items():
            for row in found:
                errors = row.errors
                print(
                    f"  {'with' if predicts else 'without':8}{1e3 * row.step:5g} ms  shaking "
                    f"{errors.shaking:8.1e}  grip {errors.grip:8.1e}  place {errors.place:8.1e}  "
                    f"{row.time:7.3f} s/s",
                    flush=True,
                )
        for error in (MOST_GRIP, MOST_GRIP / 10):
            print(f"  {_gain(task, of_laws, error)}", flush=True)


def _gain(task: Task, of_laws: dict[bool, list[Row]], error: float) -> str:
    now, before = (cheapest(task, of_laws[predicts], error) for predicts in (True, False))
    texts = [
        "none" if row is None else f"{1e3 * row.step:g} ms, {row.time:.3f} s/s"
        for row in (now, before)
    ]
    ratio = f"{before.time / now.time:.2f} times as fast" if now and before else "no ratio"
    return f"error {error:g}: with {texts[0]}; without {texts[1]}: {ratio}"
