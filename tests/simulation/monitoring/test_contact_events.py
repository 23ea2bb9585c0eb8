"""Beginnings and ends of contacts: when, where, with what impulse, and in which order."""

from __future__ import annotations

import io
import json
import math

import pytest

from somo_cli.simulation.engine.contacts import ContactPoint, LinkIndex
from somo_cli.simulation.monitoring.contact_events import ContactEvent, ContactMonitor
from somo_cli.simulation.plan.build import make_plan
from somo_cli.simulation.recording.contact_event_writer import ContactEventWriter
from somo_cli.simulation.run import run
from tests.builders.definitions import Data
from tests.builders.fake_world import FakeWorld
from tests.builders.rigid_objects import BALL, CUBE, G, scene_of_objects
from tests.builders.scenes import scene_from_file, scene_from_text

STEP = 1e-3


def pressing(first: LinkIndex, second: LinkIndex, force: float, x: float = 0.0) -> ContactPoint:
    rubs = ((0.0, 1.0, 0.0), 0.0), ((0.0, 0.0, 1.0), 0.0)
    return ContactPoint(first, second, (x, 0.0, 0.0), (1.0, 0.0, 0.0), force, rubs)


def events_of(*steps: list[ContactPoint]) -> list[ContactEvent]:
    found: list[ContactEvent] = []
    monitor = ContactMonitor(STEP, found.append)
    for number, touches in enumerate(steps, start=1):
        monitor.update(number, touches)
    return found


def test_one_contact() -> None:
    a, b = (0, 2), (1, 0)
    steps = [[pressing(b, a, force, x)] for force, x in ((0, 9), (2, 1), (5, 2), (1, 3), (0, 9))]
    assert events_of(*steps, []) == [
        ContactEvent(2, "begin", (a, b), (1, 0, 0), 2, 0.002),
        ContactEvent(5, "end", (a, b), (3, 0, 0), 5, pytest.approx(0.008)),
    ]


def test_several_points_are_one_contact_in_their_middle() -> None:
    a, b = (0, 2), (1, 0)
    points = [pressing(a, b, 1, 0), pressing(a, b, 3, 4), pressing(b, a, 4, 5), pressing(a, b, 0)]
    (event,) = events_of(points)
    assert (event.point[0], event.normal, event.impulse) == pytest.approx((4, 8, 0.008))


def test_contacts_come_in_the_order_of_their_links_whatever_the_engine_says() -> None:
    pairs = [((0, 1), (1, 0)), ((0, 2), (1, 0)), ((0, 2), (2, 0)), ((1, 0), (2, 0))]
    touches = [pressing(*pair, 1) for pair in pairs]
    for reported in (touches, touches[::-1]):
        found = events_of(reported, [], reported)
        assert [(one.step, one.kind) for one in found] == [
            *((1, "begin"),) * 4,
            *((2, "end"),) * 4,
            *((3, "begin"),) * 4,
        ]
        assert [one.pair for one in found] == pairs * 3


def test_a_contact_that_chatters_is_a_contact_each_time() -> None:
    touch = [pressing((0, 1), (1, 0), 1)]
    kinds = [(one.step, one.kind) for one in events_of(touch, [], touch, touch, [])]
    assert kinds == [(1, "begin"), (2, "end"), (3, "begin"), (5, "end")]


def lines_of(data: Data | str, steps: int) -> list[dict[str, str]]:
    pytest.importorskip("pybullet")
    from somo_cli.simulation.engine.bullet.world import BulletWorld

    scene = scene_from_file(data) if isinstance(data, str) else scene_from_text(json.dumps(data))
    plan = make_plan(scene)
    stream = io.StringIO()
    recorder = ContactEventWriter(stream, plan)
    with BulletWorld(plan) as world:
        run(plan, world, lambda values: None, steps, lambda: 0.0, on_event=recorder.write)
    header, *lines = (line.split(",") for line in stream.getvalue().splitlines())
    assert len(lines) == recorder.events
    return [dict(zip(header, line, strict=True)) for line in lines]


@pytest.mark.parametrize("scale", [1, 20])
@pytest.mark.parametrize("every", [1, 10, 1000])
def test_what_falls_touches_when_and_where_galileo_says(every: int, scale: int) -> None:
    height, mass = 0.3, 0.05
    ball = {**BALL, "position": [0.1, -0.2, 0.02 + height]}
    data = scene_of_objects(ball, ground={}, record={"every": every}, world_scale=scale)
    begin = lines_of(data, 400)[0]
    falls_for = math.sqrt(2 * height / G)
    names = [begin[one] for one in ("event", "first", "first_link", "second", "second_link")]
    assert names == ["begin", "ball", "object", "ground", "ground"]
    assert float(begin["time_s"]) == pytest.approx(falls_for, abs=2 * STEP)
    assert [float(begin[f"{axis}_m"]) for axis in "xyz"] == pytest.approx([0.1, -0.2, 0], abs=3e-3)
    # its momentum, and a little more: the engine pushes out in part what has gone in
    impulse = float(begin["impulse_ns"])
    assert impulse == pytest.approx(mass * math.sqrt(2 * G * height), rel=0.08)
    assert float(begin["normal_n"]) == pytest.approx(impulse / STEP, rel=1e-9)


def test_the_impulse_of_a_collision_is_the_momentum_that_changed_hands() -> None:
    one = {**BALL, "name": "one", "position": [0, 0, 0], "linear_velocity": [0.5, 0, 0]}
    other = {**BALL, "name": "other", "position": [0.06, 0, 0], "mass": 0.1}
    begin, end = lines_of(scene_of_objects(one, other, gravity=[0, 0, 0]), 200)
    assert (begin["event"], end["event"]) == ("begin", "end")
    # without restitution both go on together at a third of the speed
    assert float(end["impulse_ns"]) == pytest.approx(0.05 * 0.5 * 2 / 3, rel=0.01)
    assert float(end["time_s"]) > float(begin["time_s"]) == pytest.approx(0.04, abs=0.002)


def test_the_same_run_gives_the_same_events() -> None:
    first, again = (lines_of("push_scene.yaml", 1500) for _ in range(2))
    assert first == again
    assert {(one["first"], one["second"]) for one in first} >= {
        ("cube", "ground"),
        ("finger", "cube"),
    }


def test_contacts_are_not_asked_for_unless_wanted() -> None:
    plan = make_plan(scene_from_text(json.dumps(scene_of_objects(CUBE) | {"objects": []})))
    world = FakeWorld(plan)
    asked: list[int] = []
    world.contact_points = lambda: asked.append(world.steps) or []  # type: ignore[func-returns-value, method-assign]
    run(plan, world, lambda values: None, 20, lambda: 0.0)
    assert asked == []
    begun = world.steps
    run(plan, world, lambda values: None, 20, lambda: 0.0, on_event=lambda event: None)
    assert len(asked) == 20  # once for each step, the one beyond the end left out
    assert begun < asked[0]
