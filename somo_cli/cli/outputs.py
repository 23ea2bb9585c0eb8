"""The files that a command will write are known before it starts: none is read, no two are one."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from somo_cli import output_files
from somo_cli.cli.application import require

if TYPE_CHECKING:
    from somo_cli.document.parse import Document

Output: TypeAlias = tuple[str, str]
"""A path that will be written, and the option that chooses it."""


def refuse_overwriting(document: Document, output: str, option: str = "--output") -> None:
    """Exit with a usage error if an output is one of the files that were read."""
    refuse_unsafe(document.texts, [(output, option)])


def refuse_unsafe(inputs: Iterable[str], outputs: Sequence[Output]) -> None:
    """Exit with a usage error if an output is one of the inputs, or another output.

    Streams and devices may be written by several.
    """
    kept = [one for one in outputs if one[0] != "-" and not output_files.is_direct(one[0])]
    read = list(inputs)
    for number, (path, option) in enumerate(kept):
        is_input = any(_are_same(path, source) for source in read)
        require(not is_input, option, f"{path} is one of the files that are read")
        for other, _ in kept[:number]:
            require(not _are_same(path, other), option, f"{path} would be written twice")


def refuse_replacing_unknown(path: str, document_name: str) -> None:
    """Exit with a usage error if a name that a file gave is that of a file we did not write."""
    from somo_cli.manipulator.urdf import is_ours

    if not os.path.lexists(path):
        return
    is_known = Path(path).is_file() and is_ours(Path(path))
    message = (
        f"{path}, the urdf_filename of {document_name}, is a file that somo did not write: "
        "name it with -o to replace it"
    )
    require(is_known, "--output", message)


def _are_same(path: str, other: str) -> bool:
    """Whether two paths are of one file, or would be where upper and lower case are alike."""
    try:
        if Path(path).samefile(other):
            return True
    except OSError:
        pass  # one of them does not exist, or it is no path
    return os.path.realpath(path).casefold() == os.path.realpath(other).casefold()
