"""What can be recorded, as Markdown, written from the registry of quantities: never by hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.schemas import load_schema
from somo_cli.scene.column_units import unit_of
from somo_cli.scene.quantities import (
    BODY_COLUMNS,
    OBJECT_COLUMNS,
    Columns,
    Owners,
    channel_names,
    joint_names,
    link_names,
    tip_names,
    tip_orientation_names,
    tip_velocity_names,
)

_PER: dict[Owners | None, str] = {
    None: "of the whole",
    joint_names: "of each joint",
    link_names: "of each link",
    tip_names: "of each tip",
    tip_velocity_names: "of each tip",
    tip_orientation_names: "of each tip",
    channel_names: "of each actuator and axis",
}


def column_reference() -> str:
    """Return the quantities that a scene can record, with the ends of their column names."""
    lines = [
        "# Columns",
        "",
        "A scene names what it records under `record`: `columns` for manipulators, `objects` for",
        "objects, and `only` for patterns of single columns. A name is that of the manipulator or",
        "object, of a part of it, and of the value with its unit: `finger.tip.x_m`. All are in SI",
        "and in the world frame unless said otherwise; `time_s` comes first. `somo columns SCENE`",
        "lists what a scene has, `--record PATTERN` selects for one run.",
        "",
        "## Of manipulators",
        "",
        *_rows(BODY_COLUMNS),
        "",
        "## Of objects",
        "",
        *_rows(OBJECT_COLUMNS),
        "",
        "## As the schema says",
        "",
        *_descriptions(),
    ]
    return "\n".join(lines) + "\n"


def _rows(table: Mapping[Any, Columns]) -> Iterator[str]:
    yield "| quantity | columns | unit | |"
    yield "|---|---|---|---|"
    for quantity, columns in table.items():
        parts = columns.parts or ("PARTNER.fx_n", "PARTNER.normal_n", "...")
        units = dict.fromkeys(unit_of(part) or "1" for part in columns.parts or ("x.fx_n",))
        names = ", ".join(f"`{part}`" for part in parts)
        per = _PER[columns.owners] if columns.parts else "for each other body"
        yield f"| `{quantity}` | {names} | {', '.join(units)} | {per} |"


def _descriptions() -> Iterator[str]:
    record: Any = load_schema("scene")["$defs"]
    for name, field in record["record"]["properties"].items():
        yield f"- `record.{name}`: {field.get('description', '')}"
