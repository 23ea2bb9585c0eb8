from __future__ import annotations

import io
import os
import pty
import subprocess
import sys
import time

import pytest

from somo_cli import terminal
from somo_cli.problems import Problem, Span
from somo_cli.terminal import print_message, print_problems, progress


def shown(
    capsys: pytest.CaptureFixture[str], problem: Problem, text: str | None = None
) -> list[str]:
    print_problems([problem], {} if text is None else {problem.span.source: text})
    out, err = capsys.readouterr()
    assert out == ""
    assert err.endswith("\n")
    return err.removesuffix("\n").split("\n")


def test_a_problem_has_its_line_a_caret_and_a_hint(capsys: pytest.CaptureFixture[str]) -> None:
    print_problems(
        [
            Problem(Span("f.yaml", 2, 5, 6), "unknown key 'lenght'", "did you mean 'length'?"),
            Problem(Span("g.yaml", 1, 4), "strange", severity="warning"),
            Problem(Span("h.yaml", 7, 1), "no text"),
        ],
        {"f.yaml": "links:\n  - lenght: 0.1\n", "g.yaml": "a: ü"},
    )
    assert capsys.readouterr() == (
        "",
        "f.yaml:2:5: error: unknown key 'lenght'\n"
        "    - lenght: 0.1\n"
        "      ^^^^^^\n"
        "  hint: did you mean 'length'?\n"
        "g.yaml:1:4: warning: strange\n"
        "    a: ü\n"
        "       ^\n"
        "h.yaml:7:1: error: no text\n",
    )


@pytest.mark.parametrize(
    ("text", "line", "column", "width", "excerpt"),
    [
        ("a: 1\r\nb: 2\rc: 3\u2028d: 4", 4, 4, 1, ["d: 4", "   ^"]),
        ("", 1, 1, 1, []),
        ("a\n\nb", 2, 1, 1, []),
        ("a\n", 9, 1, 1, []),
        ("a: ", 1, 4, 1, ["a:", "   ^"]),
        ("a: 1", 1, 99, 1, ["a: 1", "    ^"]),
        ("a: 1", 1, 4, 99, ["a: 1", "   ^"]),
        ("    a: 1", 1, 2, 1, ["   a: 1", "^"]),
        ("a:\t1\x1b[31mred\x00\x9b", 1, 4, 3, ["a: 1\\x1b[31mred\\x00\\x9b", "   ^^^^^^"]),
        ("日本: e\u0301x", 1, 7, 1, ["日本: e\u0301x", "       ^"]),
        ("a\u202eb: \u00a0c", 1, 6, 1, ["a\\u202eb: \\xa0c", "          ^^^^"]),
        ("  ::error::x", 1, 5, 5, ["\\x3a:error::x", "     ^^^^^"]),
        ("a: '##[group]'", 1, 4, 3, ["a: '\\x23#[group]'", "   ^^^^^^"]),
    ],
)
def test_the_excerpt(
    capsys: pytest.CaptureFixture[str],
    text: str,
    line: int,
    column: int,
    width: int,
    excerpt: list[str],
) -> None:
    problem = Problem(Span("f", line, column, width), "bad")
    header, *rest = shown(capsys, problem, text)
    assert header == f"f:{line}:{column}: error: bad"
    assert rest == ["    " + part for part in excerpt]


@pytest.mark.parametrize("column", [1, 50, 100, 101, 150, 5_000, 9_991, 10_000])
def test_a_long_line_is_cut_around_the_caret(
    capsys: pytest.CaptureFixture[str], column: int
) -> None:
    text = "".join(chr(ord("a") + i % 26) for i in range(10_000))
    _, line, carets = shown(capsys, Problem(Span("f", 1, column, 5), "bad"), text)
    assert len(line) <= 104
    start, end = carets.index("^"), len(carets)
    assert line[start:end] == text[column - 1 : column + 4]
    assert line.startswith("    ... ") == (column > 47)
    assert line.endswith(" ...") == (column < 9_940)


def test_a_line_of_a_megabyte_takes_no_time(capsys: pytest.CaptureFixture[str]) -> None:
    text = "x" * 1_000_000
    problems = [Problem(Span("f", 1, i * 1_000, 10_000), "bad") for i in range(1, 500)]
    start = time.process_time()
    print_problems(problems, {"f": text})
    assert time.process_time() - start < 10
    assert max(map(len, capsys.readouterr().err.split("\n"))) <= 104


def test_a_line_of_a_hundred_columns_is_whole(capsys: pytest.CaptureFixture[str]) -> None:
    text = "x" * 100
    assert shown(capsys, Problem(Span("f", 1, 100), "bad"), text)[1:] == [
        "    " + text,
        "    " + " " * 99 + "^",
    ]


@pytest.mark.parametrize(
    "nasty",
    ["::error::x\n::stop-commands::y", "\r\n::a", "\x85::b", "\u2028::c", "  ::d", "##[e]"],
)
def test_nothing_can_start_a_line_with_a_command(
    capsys: pytest.CaptureFixture[str], nasty: str
) -> None:
    print_problems([Problem(Span(nasty, 1, 1), nasty, nasty)], {nasty: nasty})
    print_message(nasty)
    out, err = capsys.readouterr()
    assert out == ""
    for line in err.splitlines():
        assert not line.strip().startswith("::")
        assert "##[" not in line


def test_a_message_is_one_line_of_some_length(capsys: pytest.CaptureFixture[str]) -> None:
    print_message("a\nb\x1b[31m [bold]c[/bold] :smile: ü")
    assert capsys.readouterr().err == "a\\nb\\x1b[31m [bold]c[/bold] :smile: ü\n"
    print_message("x" * 1_000_000)
    assert len(capsys.readouterr().err) < 3_000


def test_a_thousand_problems_are_not_all_said(capsys: pytest.CaptureFixture[str]) -> None:
    print_problems([Problem(Span("f", i, 1), "bad") for i in range(1, 1_001)], {})
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 501
    assert lines[-1] == "and 500 more"


@pytest.mark.parametrize("stream", [None, "closed", "broken"])
def test_without_standard_error_nothing_is_reported(
    monkeypatch: pytest.MonkeyPatch, stream: str | None
) -> None:
    class Broken(io.StringIO):
        def write(self, text: str) -> int:
            raise BrokenPipeError

    replacement = {None: None, "closed": io.StringIO(), "broken": Broken()}[stream]
    if stream == "closed" and replacement is not None:
        replacement.close()
    monkeypatch.setattr(sys, "stderr", replacement)
    print_message("x")
    with progress(3, "x") as advance:
        advance(1)


CODE = """
import sys
from somo_cli.problems import Problem, Span
from somo_cli.terminal import progress, print_message, print_problems
print_message("hello [b]x[/b]")
print_problems([Problem(Span("f", 1, 4), "bad " + "y" * 200, "do :smile:")], {"f": "a: [x]"})
with progress(1000, "running [red]") as advance:
    for i in range(1001):
        advance(i)
print("rich" in sys.modules)
"""
PLAIN = (
    "hello [b]x[/b]\nf:1:4: error: bad "
    + "y" * 200
    + "\n    a: [x]\n       ^\n  hint: do :smile:\n"
)


@pytest.mark.parametrize("variable", ["NO_COLOR", "GITHUB_ACTIONS", "CI", "CLICOLOR_FORCE"])
def test_in_a_pipe_the_bytes_are_plain(variable: str) -> None:
    result = subprocess.run(
        [sys.executable, "-c", CODE],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, variable: "1"},
    )
    assert (result.stdout, result.stderr) == ("False\n", PLAIN)


def on_a_terminal(**environment: str) -> tuple[str, str]:
    # Standard output and what a terminal of standard error received.
    known = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR")}
    parent, child = pty.openpty()
    with subprocess.Popen(
        [sys.executable, "-c", CODE],
        stdout=subprocess.PIPE,
        stderr=child,
        text=True,
        env={**known, "TERM": "xterm-256color", "COLUMNS": "40", **environment},
    ) as process:
        os.close(child)
        received = b""
        while True:
            try:
                part = os.read(parent, 65536)
            except OSError:  # Linux says so at the end
                break
            if not part:
                break
            received += part
        os.close(parent)
        assert process.stdout is not None
        out = process.stdout.read()
    assert process.returncode == 0
    return out, received.decode().replace("\r\n", "\n")


def test_on_a_terminal_there_is_colour_and_progress() -> None:
    out, err = on_a_terminal()
    assert out == "True\n"
    assert "\x1b[1;31mf:1:4: error: bad " + "y" * 200 + "\x1b[0m\n" in err
    assert "    a: [x]\n" in err
    assert "running [red]" in err


def test_no_color_is_respected() -> None:
    _, err = on_a_terminal(NO_COLOR="1")
    assert err.startswith(PLAIN)
    assert "\x1b[1;31m" not in err
    assert "running [red]" in err


def test_a_dumb_terminal_gets_plain_lines() -> None:
    assert on_a_terminal(TERM="dumb") == ("False\n", PLAIN)


def in_a_pipe(**environment: str) -> str:
    known = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR")}
    command = [sys.executable, "-c", CODE]
    return subprocess.run(
        command, capture_output=True, text=True, check=True, env={**known, **environment}
    ).stderr


def test_colour_can_be_forced_in_a_pipe_without_a_bar() -> None:
    err = in_a_pipe(FORCE_COLOR="1", TERM="xterm-256color")
    assert "\x1b[1;31mf:1:4: error: bad " in err
    assert "running" not in err
    assert in_a_pipe(FORCE_COLOR="1", NO_COLOR="1") == in_a_pipe(FORCE_COLOR="0") == PLAIN


def test_in_a_pipe_progress_is_a_line_every_ten_seconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 100.0
    monkeypatch.setattr(terminal.time, "monotonic", lambda: now)
    with progress(100, "drawing", remark=lambda: ", 2 failed") as advance:
        for done, seconds in enumerate([0, 5, 9, 11, 20, 21, 30, 40], start=1):
            now = 100.0 + seconds
            advance(done)
        now = 200.0
        advance(100)  # the end needs no line
    assert capsys.readouterr().err == (
        "drawing: 4 of 100, 2 failed, 264 s remain\n"
        "drawing: 6 of 100, 2 failed, 329 s remain\n"
        "drawing: 8 of 100, 2 failed, 460 s remain\n"
    )
