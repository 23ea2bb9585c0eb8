"""somo calibrate: write a result to a copy of the definition or to the definition itself."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from somo_cli import output_files, terminal
from somo_cli.cli.application import require

if TYPE_CHECKING:
    from somo_cli.document.parse import Document
    from somo_cli.problems import Pointer


def write_result(
    document: "Document | None",
    values: "Mapping[Pointer, float]",
    piece: str,
    write: str | None,
    patch: str | None,
    beside: Mapping[str, str] | None = None,
) -> None:
    """Write values to a copy of the file that holds them, or to the file itself.

    Without a document, `piece` is written. `beside` names the key after which a new key goes.
    """
    if write is not None:
        written = piece
        if document is not None:
            (source, *others) = dict.fromkeys(document.span(place[:-1]).source for place in values)
            require(not others, "--write", f"the values are in {source} and other files: --patch")
            written = _patched(document, source, values, beside)
        output_files.write_atomically(write, written)
        terminal.print_message(f"{write}: written")
    if patch is not None and document is not None:
        output_files.write_atomically(
            patch, _patched(document, _source(document, patch), values, beside)
        )
        terminal.print_message(f"{patch}: patched")


def require_targets(document: "Document", write: str | None, patch: str | None) -> None:
    """Exit, before anything is computed, if a file cannot be patched or would be overwritten."""
    if patch is not None:
        _source(document, patch)
    is_read = write is not None and any(_is_same(write, source) for source in document.texts)
    require(
        not is_read, "--write", f"{write} is one of the files that are read: change it with --patch"
    )


def _source(document: "Document", path: str) -> str:
    """Return the name under which the file to patch was read."""
    for source in document.texts:
        if _is_same(path, source):
            return source
    names = ", ".join(document.texts)
    raise typer.BadParameter(
        f"{path} is not one of the files that were read: {names}", param_hint="'--patch'"
    )


def _is_same(path: str, source: str) -> bool:
    one, other = Path(path), Path(source)
    return path == source or (one.exists() and other.exists() and one.samefile(other))


def _patched(
    document: "Document",
    source: str,
    values: "Mapping[Pointer, float]",
    beside: Mapping[str, str] | None,
) -> str:
    from somo_cli.document.patch import patched

    return patched(document, source, values, after=beside or {})
