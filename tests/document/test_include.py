from __future__ import annotations

import errno
import os
import time
from collections.abc import Callable, Mapping

import pytest

from somo_cli.document.include import include, unresolved_references
from somo_cli.document.parse import Document, parse
from somo_cli.problems import InvalidFile, Problem, Span

HINT = "paths are relative to the file that names them, and stay in its folder or below"
PLACES = (("parts", "*"), ("parts", "*", "link"), ("base",))


def opener(files: Mapping[str, str]) -> Callable[[str, str], tuple[str, str]]:
    def open_text(naming_source: str, path: str) -> tuple[str, str]:
        folder = naming_source.rpartition("/")[0]
        source = f"{folder}/{path}" if folder else path
        if path.startswith("/"):
            raise ValueError("the path must be relative to the file that names it")
        if source not in files:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), source)
        return source, files[source]

    return open_text


def refusal(text: str, files: Mapping[str, str]) -> InvalidFile:
    document, problems = include(parse(text, "f.yaml"), PLACES, opener(files))
    return InvalidFile(problems, document.texts)


def whole(document: Document, problems: tuple[Problem, ...]) -> Document:
    assert problems == ()
    return document


def test_files_are_put_where_they_are_named() -> None:
    text = "parts:\n- a/part.yaml\n- {link: link.yaml}\n- {link: {x: 1}}\nbase: base.yaml\n"
    files = {
        "a/part.yaml": "link: deep.yaml\n",
        "a/deep.yaml": "x: 2\n",
        "link.yaml": "\nx: 3\n",
        "base.yaml": "{name: other.yaml}\n",
    }
    document = whole(*include(parse(text, "f.yaml"), PLACES, opener(files)))
    assert document.data == {
        "parts": [{"link": {"x": 2}}, {"link": {"x": 3}}, {"link": {"x": 1}}],
        "base": {"name": "other.yaml"},
    }
    assert document.texts == {"f.yaml": text, **files}
    assert document.span(("parts", 0, "link", "x")) == Span("a/deep.yaml", 1, 4)
    assert document.span(("parts", 1, "link", "x")) == Span("link.yaml", 2, 4)
    assert document.span(("parts", 1, "link", "y")) == Span("link.yaml", 1, 1)
    assert document.span(("parts", 2, "link", "x")) == Span("f.yaml", 4, 14)


@pytest.mark.parametrize(
    "text",
    ["parts: 5\nbase: null\n", "parts: ['', {}, [], 1]\nbase: ''\n", "[a.yaml]", "a.yaml", "{}"],
)
def test_what_is_not_the_name_of_a_file_is_left_to_the_schema(text: str) -> None:
    document = parse(text, "f.yaml")
    assert whole(*include(document, PLACES, opener({}))) == document


def test_a_mapping_in_place_of_a_list_names_no_files() -> None:
    document = parse("parts: {a: a.yaml, b: {}}", "f.yaml")
    assert whole(*include(document, PLACES, opener({}))) == document


@pytest.mark.parametrize(
    ("text", "found"),
    [("[1]", "a list"), ("hello", "only 'hello'"), ("5", "only 5"), ("~", "nothing")],
)
def test_a_file_that_holds_no_mapping_is_not_put_in(text: str, found: str) -> None:
    document = parse("base: a.yaml", "f.yaml")
    included, problems = include(document, PLACES, opener({"a.yaml": text}))
    span = Span("a.yaml", 1, 1, 1 if text == "[1]" else len(text))
    assert problems == (Problem(span, f"expected a mapping, found {found}"),)
    assert included.data == document.data
    assert unresolved_references(included, PLACES) == [("base",)]


def test_valid_files_are_included_beside_invalid_ones() -> None:
    document = parse("parts: [a.yaml, none.yaml, {}]\nbase: b.yaml", "f.yaml")
    included, problems = include(document, PLACES, opener({"a.yaml": "x: 1", "b.yaml": "y: 2"}))
    assert len(problems) == 1
    assert included.data == {"parts": [{"x": 1}, "none.yaml", {}], "base": {"y": 2}}
    assert unresolved_references(included, PLACES) == [("parts", 1)]


def test_one_file_may_be_named_twice() -> None:
    text = "parts: [a.yaml, a.yaml]\n"
    document = whole(*include(parse(text, "f.yaml"), PLACES, opener({"a.yaml": "link: {x: 1}"})))
    assert document.data == {"parts": [{"link": {"x": 1}}, {"link": {"x": 1}}]}
    assert document.span(("parts", 0, "link")) == document.span(("parts", 1, "link"))


def test_every_problem_of_every_file_is_reported() -> None:
    text = "parts:\n- none.yaml\n- bad.yaml\n- /etc/x\n- good.yaml\nbase: worse.yaml\n"
    files = {
        "bad.yaml": "a: 017\nb: .nan\n",
        "good.yaml": "link: gone.yaml\n",
        "worse.yaml": "a: b: c\n",
    }
    error = refusal(text, files)
    assert error.texts == {"f.yaml": text, **files}
    zero = "a number with a leading zero is ambiguous: 017"
    assert error.problems == (
        Problem(
            Span("f.yaml", 2, 3, 9), "cannot read 'none.yaml': no such file or directory", HINT
        ),
        Problem(
            Span("f.yaml", 4, 3, 6),
            "cannot use '/etc/x': the path must be relative to the file that names it",
            HINT,
        ),
        Problem(Span("bad.yaml", 1, 4, 3), zero, "write 17 or '017'"),
        Problem(Span("bad.yaml", 2, 4, 4), "not a finite number: .nan", "write an ordinary number"),
        Problem(
            Span("good.yaml", 1, 7, 9), "cannot read 'gone.yaml': no such file or directory", HINT
        ),
        Problem(
            Span("worse.yaml", 1, 5),
            "a ':' cannot stand here",
            "put the value in quotes, or check the indentation",
        ),
    )


def test_a_file_that_cannot_be_decoded_keeps_its_own_problem() -> None:
    problem = Problem(Span("x.yaml", 1, 1), "byte 0xff at offset 0 is not UTF-8")

    def open_text(naming_source: str, path: str) -> tuple[str, str]:
        raise InvalidFile([problem], {"x.yaml": "?"})

    document, problems = include(parse("base: x.yaml", "f.yaml"), PLACES, open_text)
    assert problems == (problem,)
    assert document.texts == {"f.yaml": "base: x.yaml", "x.yaml": "?"}


def test_a_file_that_names_itself_ends() -> None:
    names_itself = parse("base: f.yaml", "f.yaml")
    document = whole(*include(names_itself, PLACES, opener({"f.yaml": "base: f.yaml"})))
    assert document.data == {"base": {"base": "f.yaml"}}


def test_files_cannot_add_up_to_a_bomb() -> None:
    text = "parts: [" + "big.yaml, " * 5_000 + "]"
    big = "{a: [" + "1, " * 5_000 + "]}"
    start = time.process_time()
    error = refusal(text, {"big.yaml": big})
    assert time.process_time() - start < 10
    message = "more than 200000 values, with the files it names"
    assert error.problems == (Problem(Span("f.yaml", 1, 1), message),)


def test_many_small_files_are_put_in_place_fast() -> None:
    text = "parts: [" + "a.yaml, " * 2_000 + "]"
    start = time.process_time()
    files = {"a.yaml": "link: {x: 1, y: 2}"}
    document = whole(*include(parse(text, "f.yaml"), PLACES, opener(files)))
    assert time.process_time() - start < 10
    assert document.at(("parts", 1_999, "link", "y")) == 2
