"""Help texts: examples that are valid commands, lines that fit, completion for shells."""

from __future__ import annotations

import re
import shlex

import pytest
import typer
from typer.core import TyperGroup

from somo_cli import cli  # noqa: F401 - registers the commands
from somo_cli.cli.application import app
from tests.builders.command import Somo

ROOT = typer.main.get_command(app)
assert isinstance(ROOT, TyperGroup)
CALIBRATE = ROOT.commands["calibrate"]
assert isinstance(CALIBRATE, TyperGroup)
COMMANDS = {
    **{name: one for name, one in ROOT.commands.items() if name != "calibrate"},
    **{f"calibrate {name}": one for name, one in CALIBRATE.commands.items()},
}


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_of_the_help_are_valid_commands(name: str) -> None:
    told = (COMMANDS[name].epilog or "").replace("\\\n", " ")
    examples = re.findall(r"^  somo (.*)$", told, re.MULTILINE)
    assert examples
    for example in examples:
        words = shlex.split(example.partition(" > ")[0])
        parts = len(name.split())
        assert " ".join(words[:parts]) == name
        COMMANDS[name].make_context(name, words[parts:])  # a usage error would be raised


@pytest.mark.parametrize("name", COMMANDS)
def test_help_fits_a_terminal_and_ends_with_the_exit_codes(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    context = typer.Context(COMMANDS[name], info_name=f"somo {name}")
    lines = COMMANDS[name].get_help(context).splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[-1].strip().startswith("Exit codes: 0 success")
    assert lines[-1].endswith("see somo help commands.")


@pytest.mark.parametrize(
    ("shell", "part"),
    [("bash", "complete -o"), ("zsh", "#compdef somo"), ("fish", "complete --command somo")],
)
def test_each_shell_has_a_completion(somo: Somo, shell: str, part: str) -> None:
    script = somo(env={"_SOMO_COMPLETE": f"source_{shell}"})
    assert (script.returncode, script.stderr) == (0, "")
    assert part in script.stdout
    assert f"_SOMO_COMPLETE=complete_{shell}" in script.stdout


def test_commands_are_completed(somo: Somo) -> None:
    asked = {"_SOMO_COMPLETE": "complete_bash", "COMP_WORDS": "somo re", "COMP_CWORD": "1"}
    assert somo(env=asked).stdout.split() == ["render", "report"]
