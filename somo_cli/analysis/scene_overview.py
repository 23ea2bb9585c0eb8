"""A scene at a glance: what stands where, what drives what, what touches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from somo_cli.analysis.manipulator_overview import manipulator_overview
from somo_cli.analysis.overview import Entry, Fact
from somo_cli.scene.actuation import Actuation, WaveProfile
from somo_cli.scene.model import ExternalLoad, Manipulator, Scene
from somo_cli.scene.rigid_object import RigidObject


def scene_overview(name: str, scene: Scene) -> Entry:
    """Return a scene at a glance, in SI."""
    gravity = [float(one) for one in scene.gravity]
    text = (
        f"step {scene.time_step:g} s, {scene.integrator}, gravity {_vector(gravity)} m/s², "
        f"a row every {scene.every} steps"
    )
    facts: dict[str, Fact] = {
        "time_step_s": scene.time_step,
        "integrator": scene.integrator,
        "gravity_m_per_s2": gravity,
        "every": scene.every,
        "stop_conditions": len(scene.stop_conditions),
    }
    parts = [_manipulator(one) for one in scene.manipulators]
    parts += [_object(one) for one in scene.objects]
    if scene.ground is not None:
        height, friction = scene.ground.height, scene.ground.surface.friction
        text_of = f"at z = {height:g} m, friction {friction:g}"
        parts.append(Entry("ground", text_of, {"height_m": height, "friction": friction}))
    return Entry(name, text, facts, parts)


def _manipulator(one: Manipulator) -> Entry:
    whole = manipulator_overview(one.name, one.compiled.chain)
    text = f"{whole.text}; base {one.base} at {_vector(one.position)} m"
    facts = {**whole.facts, "base": one.base, "position_m": list(one.position)}
    driven = [*map(_actuation, one.actuation), *map(_load, one.loads)]
    return Entry(one.name, text, facts, [*whole.parts, *driven])


def _actuation(one: Actuation) -> Entry:
    profile = one.profile
    if isinstance(profile, WaveProfile):
        wave = profile.wave
        about = (
            f"{wave.shape} of {wave.amplitude:.4g} N·m about {wave.offset:.4g} N·m at "
            f"{wave.frequency:.4g} Hz"
        )
    elif profile.constant_value is not None:
        about = f"{profile.constant_value:.4g} N·m"
    else:
        values = [value for _, value in profile.points]
        end = profile.points[-1][0]
        about = (
            f"{min(values):.4g} to {max(values):.4g} N·m, {len(profile.points)} waypoints over "
            f"{end:.4g} s{', repeated' if profile.repeat else ''}"
        )
    name = f"drive of actuator {one.actuator}, axis {one.axis}"
    facts: dict[str, Fact] = {"actuator": one.actuator, "axis": one.axis, "torque": about}
    return Entry(name, f"{about} in each joint", facts)


def _load(one: ExternalLoad) -> Entry:
    force, moment = _vector(one.force), _vector(one.moment)
    text = f"{force} N and {moment} N·m on link {one.link}, in the axes of the {one.frame}"
    return Entry(
        "load", text, {"link": one.link, "force_n": list(one.force), "moment_nm": list(one.moment)}
    )


def _object(one: RigidObject) -> Entry:
    link = one.chain.links[0]
    shapes = ", ".join(_shapes(type(shape.solid).__name__.lower() for shape in link.shapes))
    moves = "fixed" if one.is_fixed else "moves as prescribed" if one.motion else "free"
    friction = one.surface.friction
    mass = "" if one.has_prescribed_pose else f", {link.inertial.mass:.4g} kg"
    touches = "" if one.collides else ", nothing touches it"
    placed = f"on {one.placement.on}" if one.placement else f"at {_vector(one.position)} m"
    text = f"{shapes}, {moves}{mass}, {placed}, friction {friction:g}{touches}"
    facts: dict[str, Fact] = {
        "shapes": shapes,
        "moves": moves,
        "mass_kg": link.inertial.mass,
        "position_m": list(one.position),
        "friction": friction,
    }
    return Entry(one.name, text, facts)


def _shapes(names: Iterator[str]) -> Iterator[str]:
    known = list(names)
    for name in dict.fromkeys(known):
        count = known.count(name)
        yield name if count == 1 else f"{count} x {name}"


def _vector(values: Sequence[float]) -> str:
    return "(" + ", ".join(f"{float(one):.4g}" for one in values) + ")"
