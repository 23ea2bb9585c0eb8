"""Import PyBullet, where it is installed, and connect to an engine of its own."""

from __future__ import annotations

import sys
from functools import partial
from types import BuiltinFunctionType
from typing import Any

from somo_cli.problems import EngineMissing


def import_pybullet(missing: str = "the engine, PyBullet, is") -> Any:
    """Return PyBullet's module.

    Raises EngineMissing where it is not installed; `missing` says what is missing then.
    """
    try:
        import pybullet
    except ImportError as error:
        raise EngineMissing(
            f"{missing} not installed for this Python "
            f"({sys.version_info.major}.{sys.version_info.minor}); "
            "build and check work without it"
        ) from error
    return pybullet


class BulletClient:
    """One engine of a process, which may have several: PyBullet's names, bound to this engine.

    Its functions are called without `physicsClientId`. The keyword costs about 0.1 µs a call, so
    code that runs for every body in every step calls `module` and passes `number` by position.
    """

    def __init__(self, missing: str = "the engine, PyBullet, is") -> None:
        self.module = import_pybullet(missing)
        self.number: int = self.module.connect(self.module.DIRECT)

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.module, name)
        if isinstance(found, BuiltinFunctionType):
            found = partial(found, physicsClientId=self.number)
        setattr(self, name, found)  # looked up once
        return found

    def close(self) -> None:
        """Free the engine; a second call does nothing."""
        if self.number >= 0:
            module, number = self.module, self.number
            vars(self).clear()  # the next engine may get the number that names were bound to
            self.module, self.number = module, -1
            module.disconnect(number)
