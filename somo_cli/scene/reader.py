"""Reads a scene from a document without errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from somo_cli.document.parse import Document
from somo_cli.manipulator import geometry
from somo_cli.manipulator import read as manipulator_read
from somo_cli.manipulator.assembly import is_assembly
from somo_cli.manipulator.chain import Chain, Limb
from somo_cli.manipulator.compile import Compiled, DefinitionCompiler
from somo_cli.manipulator.dimensions import Scale
from somo_cli.scene import actuation, contact_surface
from somo_cli.scene import stop_conditions as stop_conditions_module
from somo_cli.scene.model import (
    ALL_OBJECT_QUANTITIES,
    ALL_QUANTITIES,
    AUTOMATIC_TIME_STEP,
    DEFAULT_GRAVITY,
    DEFAULT_QUANTITIES,
    DEFAULT_TIME_STEP,
    NEUTRAL,
    ExternalLoad,
    Manipulator,
    Quantity,
    Scene,
)
from somo_cli.scene.prescribed_motion import read_motion, start_pose_of
from somo_cli.scene.rigid_object import read_object
from somo_cli.scene.sorotraj import Trajectory, read_trajectory


def read_trajectories(data: Any) -> Mapping[str, Trajectory]:
    """Return the trajectories of a scene without errors, by name."""
    return {
        item["name"]: read_trajectory(
            item["sorotraj"],
            int(item.get("repetitions", 1)),
            float(item.get("speed_factor", 1)),
            item.get("invert", False),
        )
        for item in data.get("trajectories", ())
    }


def read_scene(document: Document, definitions: DefinitionCompiler | None = None) -> Scene:
    """Return the scene of a document without errors.

    `definitions` has what the checks compiled already. Where the scene leaves the time step to us,
    it is the default one here: `loading` chooses it.
    """
    definitions = definitions or DefinitionCompiler(document)
    data: Any = document.data
    record = data.get("record", {})
    only = tuple(record.get("only", ()))
    trajectories = read_trajectories(data)
    manipulators = tuple(
        _manipulator(item, definitions.at(("manipulators", index, "definition")), trajectories)
        for index, item in enumerate(data.get("manipulators", ()))
    )
    scale = manipulator_read.world_scale(document)
    if scale is None:
        scale = next((one.compiled.scale for one in manipulators), None) or Scale()
    time_step = data.get("time_step", DEFAULT_TIME_STEP)
    is_chosen = time_step == AUTOMATIC_TIME_STEP
    return Scene(
        time_step=DEFAULT_TIME_STEP if is_chosen else float(time_step),
        gravity=geometry.vector(data.get("gravity", DEFAULT_GRAVITY)),
        integrator=data.get("integrator", "implicit"),
        scale=scale,
        manipulators=manipulators,
        every=int(record.get("every", 1)),
        columns=tuple(
            dict.fromkeys(record.get("columns", ALL_QUANTITIES if only else _default_columns(data)))
        ),
        reference=data.get("reference"),
        ground=contact_surface.read_ground(data["ground"]) if "ground" in data else None,
        objects=tuple(read_object(item, trajectories) for item in data.get("objects", ())),
        object_quantities=tuple(
            dict.fromkeys(record.get("objects", ALL_OBJECT_QUANTITIES if only else ("pose",)))
        ),
        only=only,
        stop_conditions=stop_conditions_module.read_stop_conditions(data.get("stop", ())),
        has_contact_events=bool(record.get("events", False)),
        is_time_step_automatic=is_chosen,
        duration=float(data["duration"]) if "duration" in data else None,
    )


def _default_columns(data: Any) -> tuple[Quantity, ...]:
    """Return what is recorded of manipulators where a scene does not say it.

    A base that can move is needed to draw the run, and contact is what a scene with a ground or
    objects is about.
    """
    bases = [item.get("base", "static") for item in data.get("manipulators", ())]
    moves = any(base == "free" for base in bases) or any(
        "motion" in item for item in data.get("manipulators", ())
    )
    touches = "ground" in data or any(
        item.get("collides", True) for item in data.get("objects", ())
    )
    found = list(DEFAULT_QUANTITIES)
    found += ["base_pose"] if moves else []
    found += ["contact_force"] if touches else []
    return tuple(found)


def _manipulator(
    data: Any, compiled: Compiled, trajectories: Mapping[str, Trajectory]
) -> Manipulator:
    count = len(compiled.chain.joints)
    motion = read_motion(data["motion"], trajectories) if "motion" in data else None
    position, rpy = start_pose_of(data, motion)
    return Manipulator(
        name=manipulator_name_of(data),
        compiled=compiled,
        position=position,
        rpy=rpy,
        base=data.get("base", "static"),
        initial_angles=initial_angles_of(data.get("initial_angles", 0), compiled.chain),
        initial_rates=values_per_joint(data.get("initial_rates", 0), count),
        linear_velocity=geometry.vector(data.get("linear_velocity", (0, 0, 0))),
        angular_velocity=geometry.vector(data.get("angular_velocity", (0, 0, 0))),
        actuation=tuple(
            one
            for item in data.get("actuation", ())
            for one in actuation.read_actuation(item, compiled.definition, trajectories)
        ),
        loads=tuple(_load(item, compiled.chain) for item in data.get("loads", ())),
        surfaces=contact_surface.read_surfaces(data.get("surface", {})),
        has_self_collision=bool(data.get("self_collision", False)),
        motion=motion,
    )


def manipulator_name_of(data: Any) -> str:
    """Return the name of a manipulator of a scene: its own, else its definition's."""
    definition = data["definition"]
    key = "assembly_name" if is_assembly(definition) else "manipulator_name"
    return str(data.get("name", definition[key]))


def initial_angles_of(value: Any, chain: Chain) -> tuple[float, ...]:
    """Return the angle at the start of every joint of a chain [rad], from what a scene says.

    That is one number for all, a list of them, or "neutral": the angles of the relaxed springs.
    """
    if value == NEUTRAL:
        return chain.neutral_angles
    return values_per_joint(value, len(chain.joints))


def values_per_joint(value: Any, count: int) -> tuple[float, ...]:
    """Return one number per joint from one number for all, or from a list of them."""
    return tuple(map(float, value)) if isinstance(value, list) else (float(value),) * count


def _load(data: Any, chain: Chain) -> ExternalLoad:
    link = data.get("link", "tip")
    point = geometry.vector(data.get("point", (0, 0, 0)))
    if link in limbs_by_tip_name(chain):
        point = geometry.add(limbs_by_tip_name(chain)[link].tip, point)
    waypoints = data.get("waypoints", ((0, 1),))
    return ExternalLoad(
        link=link_index(link, chain),
        point=point,
        force=geometry.vector(data.get("force", (0, 0, 0))),
        moment=geometry.vector(data.get("moment", (0, 0, 0))),
        frame=data.get("frame", "world"),
        waypoints=tuple((float(time), float(factor)) for time, factor in waypoints),
        interpolation=data.get("interpolation", "linear"),
        repeat=bool(data.get("repeat", False)),
    )


def link_index(name: str, chain: Chain) -> int:
    """Return the place in a chain of the link of this name, of the one that has it for a tip.

    Raises ValueError if there is none.
    """
    if name in limbs_by_tip_name(chain):
        return limbs_by_tip_name(chain)[name].last_link
    return [link.name for link in chain.links].index(name)


def limbs_by_tip_name(chain: Chain) -> Mapping[str, Limb]:
    """Return what the tips of a chain are called: `tip`, or after the limbs of an assembly."""
    return {f"{limb.prefix}tip": limb for limb in chain.backbones}
