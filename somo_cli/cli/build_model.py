"""The text that somo build writes, in the format and at the scale that a program wants."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

from somo_cli import document_kinds, loading, terminal
from somo_cli.cli.application import require
from somo_cli.exchange import targets
from somo_cli.exchange.targets import Target

if TYPE_CHECKING:
    from somo_cli.document.parse import Document
    from somo_cli.manipulator.chain import Chain
    from somo_cli.manipulator.compile import Compiled


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the options of `somo build` ask for; `scale` is a length factor, None that of the file.

    `is_free` says that the base is free, which SDF and MJCF say and URDF leaves to its reader.
    """

    target: Target
    scale: float | None = None
    tip_frame: str | None = None
    is_free: bool = False


def target_of(format_name: str | None, program: str | None) -> Target:
    """Return the target of --format and --for; exit with a usage error for a wrong one."""
    formats, programs = ", ".join(targets.FORMATS), ", ".join(targets.PROGRAMS)
    is_format = format_name is None or format_name in targets.FORMATS
    require(is_format, "--format", f"{format_name!r} is not one of {formats}")
    is_program = program is None or program in targets.PROGRAMS
    require(is_program, "--for", f"{program!r} is not one of {programs}")
    if program is None:
        return targets.FORMATS[cast(targets.Format, format_name or "urdf")]
    target = targets.PROGRAMS[cast(targets.Program, program)]
    does_agree = format_name in (None, target.format)
    require(does_agree, "--for", f"{program} takes {target.format}, not {format_name}")
    return target


def require_possible(wanted: Wanted, is_scene: bool, is_verified: bool) -> None:
    """Exit with a usage error for options that do not go together."""
    target = wanted.target
    is_urdf = target.format == "urdf"
    is_right = wanted.scale in (None, 1.0) or (is_urdf and not target.is_si)
    require(is_right, "--scale", "this format or program takes SI, a scale of 1")
    require(is_urdf or not is_verified, "--verify", "it reads a URDF back, no other format")
    is_right = target.format == "mjcf" or not is_scene
    require(is_right, "--format", "only mjcf takes a whole scene")
    require(not (is_urdf and wanted.is_free), "--free-base", "a URDF does not say what holds it")
    if is_scene:
        require(wanted.tip_frame is None, "--tip-frame", "a scene has sites called tip already")
        require(not wanted.is_free, "--free-base", "a scene says base: free")


@dataclass(frozen=True, slots=True)
class Model:
    """The text of a model, lines about it, and the file name that its definition asks for."""

    text: str
    summary: tuple[str, ...]
    urdf_filename: str | None = None


def of_definition(document: Document, wanted: Wanted, is_verified: bool) -> Model:
    """Return the model of a definition, printing the warnings about it.

    Raises InvalidFile, and EngineRefused if the URDF read back differs.
    """
    from somo_cli.manipulator.compile import compile_definition
    from somo_cli.manipulator.dimensions import Scale

    document_kinds.refuse_scene(document)
    compiled = compile_definition(document)
    terminal.print_problems(compiled.warnings, document.texts)
    if wanted.tip_frame is not None:
        _require_new_frames(compiled.chain, wanted.tip_frame)
    own = Scale() if wanted.target.is_si else compiled.scale or Scale()
    scale = own if wanted.scale is None else Scale(wanted.scale, own.mass)
    if wanted.target.format != "urdf":
        text = _si_text(document, compiled, wanted)
        note = "SI" if compiled.scale else "in the units of the file, which gives no world scale"
    else:
        text = compiled.urdf(scale, wanted.tip_frame, wanted.target.has_all_limits)
        note = targets.scale_note(scale)
    if is_verified:
        from somo_cli.manipulator.urdf_readback import require_equal

        require_equal(text, compiled.scaled_chain(scale))
    summary = compiled.described(scale) + (f": {note}" if note else "")
    return Model(text, (summary,), compiled.definition.urdf_filename)


def _si_text(document: Document, compiled: Compiled, wanted: Wanted) -> str:
    from somo_cli.analysis.explicit_springs import stable_step  # slow to import
    from somo_cli.exchange import mjcf, sdf

    is_fixed = not wanted.is_free
    if wanted.target.format == "sdf":
        return sdf.render_chain(compiled.chain, wanted.tip_frame, is_fixed)
    step = stable_step(loading.scene_of(document)[0])
    tip_frame = wanted.tip_frame or "tip"
    return mjcf.render_chain(compiled.chain, step, tip_frame=tip_frame, is_fixed=is_fixed)


def of_scene(document: Document) -> Model:
    """Return the MJCF of a scene, printing the warnings about it. Raises InvalidFile."""
    from somo_cli.analysis.explicit_springs import stable_step
    from somo_cli.exchange import mjcf_scene, unwritten

    scene, problems = loading.scene_of(document)
    terminal.print_problems(problems, document.texts)
    step = stable_step(scene)
    name = Path(document.source).stem if document.source != "-" else "scene"
    text = mjcf_scene.render_scene(scene, name, step)
    joints = sum(len(one.compiled.chain.joints) for one in scene.manipulators)
    lines = [
        f"manipulators: {len(scene.manipulators)}, joints: {joints}, objects: "
        f"{len(scene.objects)}, SI, time step {step:g} s"
    ]
    if step < scene.time_step:
        lines[0] += f", not {scene.time_step:g}: the springs of MuJoCo need it"
    lines += [f"  not in it: {part}" for part in unwritten.parts_not_in_mjcf(scene)]
    return Model(text, tuple(lines))


def default_name(source: str, target: Target) -> str:
    """Return the name of a file that is written unless another is asked for."""
    return f"{Path(source).stem}{targets.SUFFIXES[target.format]}"


def _require_new_frames(chain: Chain, tip_frame: str) -> None:
    names = {link.name for link in chain.links}
    frames = {f"{limb.prefix}{tip_frame}" for limb in chain.backbones}
    require(names.isdisjoint(frames), "--tip-frame", f"a link is named {tip_frame} already")
