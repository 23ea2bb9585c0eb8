"""The same bodies without the corrections that are applied before each step."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from unittest.mock import patch

from somo_cli.simulation.engine.bullet import contact_parameters
from somo_cli.simulation.engine.bullet.rolling_adapter import RollingAdapter
from somo_cli.simulation.engine.bullet.sliding_adapter import SlidingAdapter


@contextmanager
def uncorrected() -> Iterator[None]:
    """Leave contact to the engine: no corrections, and its own gap on soft ground."""
    with ExitStack() as stack:
        for adapter in (SlidingAdapter, RollingAdapter):
            stack.enter_context(patch.object(adapter, "apply", lambda _: None))
        gap = contact_parameters.DEFAULT_GAP
        stack.enter_context(patch.object(contact_parameters, "SOFT_GAP", gap))
        yield
