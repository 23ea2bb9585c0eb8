"""The unit that the name of a column ends with."""

from __future__ import annotations

_UNITS = {
    **{"m": "m", "rad": "rad", "n": "N", "nm": "N·m", "s": "s", "pa": "Pa", "j": "J", "kg": "kg"},
    **{"m_per_s": "m/s", "rad_per_s": "rad/s", "per_m": "1/m"},
}


def unit_of(column: str) -> str:
    """Return the unit of a column, such as "m/s" for ball.velocity.x_m_per_s; empty without one."""
    last = column.rpartition(".")[2]
    ends = [end for end in _UNITS if last.endswith(f"_{end}")]
    return _UNITS[max(ends, key=len)] if ends else ""
