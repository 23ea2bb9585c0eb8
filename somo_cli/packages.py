"""Find files of ROS packages and Gazebo models: package://NAME/path, model://NAME/path."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from somo_cli import files

Packages = Mapping[str, str]


class Access(NamedTuple):
    """The files that may be read besides those in the folder of the file that names them.

    `announce` takes a message before work that takes seconds.
    """

    allow_outside: bool = False
    packages: Packages | None = None
    announce: Callable[[str], None] | None = None


_REFERENCE = re.compile(r"(?:package|model)://([^/]+)/(.+)")


def read_packages(options: Sequence[str]) -> dict[str, str]:
    """Return the folder of each name from texts NAME=FOLDER. Raises ValueError for other texts."""
    found: dict[str, str] = {}
    for option in options:
        name, _, folder = option.partition("=")
        if not name or not folder:
            raise ValueError(f"{option!r} is not NAME=FOLDER")
        if not Path(folder).is_dir():
            raise ValueError(f"there is no folder {folder!r}")
        found[name] = folder
    return found


def open_reference(
    packages: Packages, naming_source: str, reference: str, **options: Any
) -> tuple[str, str]:
    """Return source and text of a file that another names, as `files.open_reference` does.

    The file may also lie in a package. Files of a package may name any file of that package.
    Raises what `files.open_reference` raises, with the same options.
    """
    parts = _REFERENCE.fullmatch(reference)
    if parts:
        name, path = parts.groups()
        if name not in packages:
            raise ValueError(f"its folder is not known: give --package {name}=FOLDER")
        return files.open_reference(str(Path(packages[name]) / "_"), path, **options)
    here = os.path.realpath(naming_source)
    for folder in packages.values():
        if Path(here).is_relative_to(os.path.realpath(folder)):
            return files.open_reference(
                naming_source, reference, **{**options, "root": str(Path(folder) / "_")}
            )
    return files.open_reference(naming_source, reference, **options)
