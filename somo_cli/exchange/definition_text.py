"""Write a definition that was found in a model as YAML, equal parts once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from somo_cli.manipulator.urdf import number


def definition_text(data: Mapping[str, Any], comment: str) -> str:
    """Return the YAML of a definition after a comment."""
    lines = [f"# {line}" for line in comment.splitlines()]
    lines += _Writer(data).mapping(data, "")
    return "\n".join(lines) + "\n"


class _Writer:
    """Writes mappings in blocks, equal ones once: later ones refer to the first by its anchor."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self._counts: dict[str, int] = {}
        self._anchors: dict[str, str] = {}
        self._count(data)

    def _count(self, value: object) -> None:
        """Count equal mappings, those in a repeated one only once: they are written once."""
        if isinstance(value, Mapping):
            text = _flow(value)
            self._counts[text] = self._counts.get(text, 0) + 1
            if self._counts[text] == 1:
                for item in value.values():
                    self._count(item)
        elif _is_list_of_mappings(value):
            for item in value:  # type: ignore[attr-defined]
                self._count(item)

    def mapping(self, data: Mapping[str, Any], indent: str) -> list[str]:
        """Return the lines of a mapping."""
        lines = []
        for key, value in data.items():
            if isinstance(value, Mapping):
                lines += self._block(value, f"{indent}{key}:", indent + "  ", key)
            elif _is_list_of_mappings(value):
                lines.append(f"{indent}{key}:")
                for item in value:
                    lines += self._item(item, indent + "  ", key)
            else:
                lines.append(f"{indent}{key}: {_flow(value)}")
        return lines

    def _block(self, value: Mapping[str, Any], start: str, indent: str, key: str) -> list[str]:
        mark, is_new = self._mark(value, key)
        return [start + mark, *(self.mapping(value, indent) if is_new else ())]

    def _item(self, value: Mapping[str, Any], indent: str, key: str) -> list[str]:
        mark, is_new = self._mark(value, key)
        if not is_new:
            return [f"{indent}-{mark}"]
        lines = self.mapping(value, indent + "  ")
        if mark:
            return [f"{indent}-{mark}", *lines]
        return [f"{indent}- {lines[0].lstrip()}", *lines[1:]]

    def _mark(self, value: Mapping[str, Any], key: str) -> tuple[str, bool]:
        """Return the anchor or the reference of a mapping, and whether it is written here."""
        text = _flow(value)
        if text in self._anchors:
            return f" *{self._anchors[text]}", False
        if self._counts[text] == 1:
            return "", True
        stem = key.removesuffix("s").removesuffix("_definition")
        self._anchors[text] = (
            stem if stem not in self._anchors.values() else f"{stem}_{len(self._anchors)}"
        )
        return f" &{self._anchors[text]}", True


def _is_list_of_mappings(value: object) -> bool:
    return isinstance(value, Sequence) and any(isinstance(item, Mapping) for item in value)


def _flow(value: object) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, bool | int):
        return str(int(value))
    assert isinstance(value, float)
    return number(value)
