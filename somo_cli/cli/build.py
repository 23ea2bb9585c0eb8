"""somo build: compile a definition to URDF, SDF or MJCF, or a scene to MJCF."""

from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import output_files, terminal
from somo_cli.cli.application import (
    QuietOption,
    SetOption,
    announcer,
    app,
    examples_of,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_overwriting, refuse_replacing_unknown

if TYPE_CHECKING:
    from somo_cli.cli.build_model import Wanted
    from somo_cli.document.parse import Document


@app.command(
    short_help="Compile a definition into a scaled URDF.",
    epilog=examples_of(
        "somo build finger.yaml", "somo build finger.yaml --for gazebo -o finger.sdf"
    ),
)
@report_errors
def build(
    definition: Annotated[
        str,
        typer.Argument(
            help="A definition of a manipulator or an assembly, YAML or JSON; for MJCF a scene too."
        ),
    ],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="The model to write; - is standard output. [default: for a URDF the definition's "
            "urdf_filename, else its own name with .urdf, .sdf or .xml, in the current directory]",
        ),
    ] = None,
    format_name: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="FORMAT",
            help="urdf, at the world scale of the file, or in SI sdf or mjcf, which have the "
            "springs too. [default: urdf]",
        ),
    ] = None,
    program: Annotated[
        str | None,
        typer.Option(
            "--for",
            metavar="PROGRAM",
            help="Choose format and scale for pybullet, gazebo, mujoco, drake or isaac.",
        ),
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option(
            "--scale", metavar="X", help="Length factor of a URDF, instead of the one in the file."
        ),
    ] = None,
    sets: SetOption = None,
    tip_frame: Annotated[
        str | None,
        typer.Option(
            "--tip-frame",
            metavar="NAME",
            help="Add a massless link of this name at the tip, in SDF a frame, in MJCF a site; in "
            "an assembly, one for each limb, such as thumb_NAME.",
        ),
    ] = None,
    is_free: Annotated[
        bool,
        typer.Option("--free-base", help="Let the base of an SDF or MJCF move freely."),
    ] = False,
    verify: Annotated[
        bool,
        typer.Option("--verify", help="Read the URDF back with yourdfpy and compare."),
    ] = False,
    quiet: QuietOption = False,
) -> None:
    """Compile a definition into URDF, SDF or MJCF, or a scene into MJCF, for other programs."""
    from somo_cli import document_kinds, loading
    from somo_cli.cli import build_model
    from somo_cli.scene.model import is_scene

    require(scale is None or 1e-6 <= scale <= 1e6, "--scale", f"{scale} is not from 1e-6 to 1e6")
    is_name = tip_frame is None or _is_name(tip_frame)
    require(is_name, "--tip-frame", f"{tip_frame!r} is not a safe name")
    target = build_model.target_of(format_name, program)
    wanted = build_model.Wanted(target, scale, tip_frame, is_free)
    document = loading.load(definition, sets or [], announce=announcer())
    is_whole = is_scene(document)
    if target.format == "urdf":
        document_kinds.refuse_scene(document)
    build_model.require_possible(wanted, is_whole, verify)
    made = (
        build_model.of_scene(document)
        if is_whole
        else build_model.of_definition(document, wanted, verify)
    )
    written = output or _default_output(definition, made.urdf_filename, wanted)
    _write(document, written, made.text)
    if not quiet and written != "-":
        first, *others = made.summary
        for line in (f"{written}: {first}", *others):
            terminal.print_message(line)


def _write(document: "Document", written: str, text: str) -> None:
    refuse_overwriting(document, written)
    if written == "-":
        with output_files.open_partial("-") as stream:
            stream.write(text)
    else:
        output_files.write_atomically(written, text)


def _default_output(definition: str, urdf_filename: str | None, wanted: "Wanted") -> str:
    """Return the model's name by its definition, which replaces no file that somo did not write."""
    from somo_cli.cli.build_model import default_name

    if wanted.target.format != "urdf" or not urdf_filename:
        return default_name(definition, wanted.target)
    refuse_replacing_unknown(urdf_filename, definition)
    return urdf_filename


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier() and len(text) <= 64
