"""What the checks say of a scene that is given as plain data."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from somo_cli.document.parse import parse
from somo_cli.problems import Problem
from somo_cli.scene.checks import scene as scene_checks


def problems_of(data: Mapping[str, Any]) -> tuple[Problem, ...]:
    """Return all problems that the checks find in a scene, in their order."""
    return tuple(scene_checks.scene_problems(parse(json.dumps(data), "a.json")))


def messages_of(data: Mapping[str, Any]) -> list[str]:
    """Return the messages of all problems of a scene."""
    return [problem.message for problem in problems_of(data)]


def messages_and_hints(data: Mapping[str, Any]) -> list[tuple[str, str | None]]:
    """Return message and hint of all problems of a scene."""
    return [(problem.message, problem.hint) for problem in problems_of(data)]


def texts_and_messages(data: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return, for all problems of a scene, the text that the position covers and the message."""
    text = json.dumps(data, indent=1)
    lines = text.splitlines()
    found = []
    for problem in scene_checks.scene_problems(parse(text, "a.json")):
        line, start = lines[problem.span.line - 1], problem.span.column - 1
        found.append((line[start : start + problem.span.width], problem.message))
    return found
