"""The fields of a file as Markdown, written from its JSON Schema: never by hand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from somo_cli.document.schemas import load_schema


def schema_reference(name: str) -> str:
    """Return every field of a schema, part by part: its name, whether it must be there, meaning."""
    schema: Any = load_schema(name)
    lines = [f"## {name}", "", str(schema.get("description", "")), ""]
    lines += _part(schema, ())
    for part, definition in schema.get("$defs", {}).items():
        if definition.get("properties"):
            lines += ["", f"### {name}: {definition.get('title', part)}", ""]
            lines += [definition["description"], ""] if "description" in definition else []
            lines += _part(definition, ())
    return "\n".join(lines) + "\n"


def _part(schema: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    required = schema.get("required", ())
    for name, field in schema.get("properties", {}).items():
        here = (*path, name)
        needed = ", required" if name in required else ""
        text = field.get("description", "")
        choices = field.get("enum")
        one_of = f" One of {', '.join(map(str, choices))}." if choices else ""
        yield f"- `{'.'.join(here)}`{needed}: {text}.{one_of}"
        inner = field if "properties" in field else field.get("items")
        if isinstance(inner, Mapping):
            yield from _part(inner, here)
