"""Run the studies and print their tables: `make studies`; with names, only these."""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import time
from pathlib import Path

from tests import studies

NO_STUDIES = ("__main__", "running")


def names() -> list[str]:
    """Return the names of the studies: the modules beside this one that have a `study`."""
    found = (module.name for module in pkgutil.iter_modules(studies.__path__))
    return [name for name in found if hasattr(_module(name), "study")]


def _module(name: str) -> object:
    return importlib.import_module(f"tests.studies.{name}") if name not in NO_STUDIES else None


def main() -> None:
    """Run what is asked for, each with its time; draw their figures into a folder, if given."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("names", nargs="*", choices=[[], *names()], default=[])
    arguments.add_argument("--pictures", type=Path, help="a folder for the figures")
    options = arguments.parse_args()
    for name in options.names or names():
        started = time.perf_counter()
        print(f"## {name}", flush=True)
        _module(name).study(options.pictures)  # type: ignore[attr-defined]
        print(f"({time.perf_counter() - started:.0f} s)\n", flush=True)


if __name__ == "__main__":
    main()
