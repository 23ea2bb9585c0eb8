"""somo build: compile a definition to a scaled URDF."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from somo_cli import output_files, terminal
from somo_cli.cli.application import (
    EXIT_CODES,
    QuietOption,
    SetOption,
    app,
    report_errors,
    require,
)
from somo_cli.cli.outputs import refuse_overwriting, refuse_replacing_unknown

if TYPE_CHECKING:
    from somo_cli.manipulator.chain import Chain


@app.command(epilog=EXIT_CODES)
@report_errors
def build(
    definition: Annotated[
        str, typer.Argument(help="A definition of a manipulator or an assembly, YAML or JSON.")
    ],
    output: Annotated[
        str | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="The URDF to write; - is standard output. [default: the definition's "
            "urdf_filename, else its own name with .urdf, in the current directory]",
        ),
    ] = None,
    scale: Annotated[
        float | None,
        typer.Option("--scale", metavar="X", help="Length factor, instead of the one in the file."),
    ] = None,
    sets: SetOption = None,
    tip_frame: Annotated[
        str | None,
        typer.Option(
            "--tip-frame",
            metavar="NAME",
            help="Add a massless link of this name at the tip; in an assembly, one for each limb, "
            "such as thumb_NAME.",
        ),
    ] = None,
    verify: Annotated[
        bool,
        typer.Option("--verify", help="Read the URDF back with yourdfpy and compare."),
    ] = False,
    quiet: QuietOption = False,
) -> None:
    """Compile the definition of a manipulator or an assembly into a scaled URDF."""
    from somo_cli import document_kinds, loading
    from somo_cli.manipulator.compile import compile_definition
    from somo_cli.manipulator.dimensions import Scale

    is_scale = scale is None or 1e-6 <= scale <= 1e6
    require(is_scale, "--scale", f"{scale} is not from 1e-6 to 1e6")
    is_name = tip_frame is None or _is_name(tip_frame)
    require(is_name, "--tip-frame", f"{tip_frame!r} is not a safe name")
    document = loading.load(definition, sets or [])
    document_kinds.refuse_scene(document)
    compiled = compile_definition(document)
    terminal.print_problems(compiled.warnings, document.texts)
    if tip_frame is not None:
        _require_new_frames(compiled.chain, tip_frame)
    own = compiled.scale or Scale()
    wanted = own if scale is None else Scale(scale, own.mass)
    text = compiled.urdf(wanted, tip_frame)
    if verify:
        from somo_cli.manipulator.urdf_readback import require_equal

        require_equal(text, compiled.scaled_chain(wanted))
    written = output or _default_output(definition, compiled.definition.urdf_filename)
    refuse_overwriting(document, written)
    if written == "-":
        with output_files.open_partial("-") as stream:
            stream.write(text)
        return
    output_files.write_atomically(written, text)
    if not quiet:
        terminal.print_message(f"{written}: {compiled.described(wanted)}")


def _require_new_frames(chain: "Chain", tip_frame: str) -> None:
    names = {link.name for link in chain.links}
    frames = {f"{limb.prefix}{tip_frame}" for limb in chain.backbones}
    require(names.isdisjoint(frames), "--tip-frame", f"a link is named {tip_frame} already")


def _default_output(definition: str, urdf_filename: str | None) -> str:
    """Return the URDF's name by its definition, which replaces no file that somo did not write."""
    if not urdf_filename:
        return f"{Path(definition).stem}.urdf"
    refuse_replacing_unknown(urdf_filename, definition)
    return urdf_filename


def _is_name(text: str) -> bool:
    return text.isascii() and text.isidentifier() and len(text) <= 64
