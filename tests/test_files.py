from __future__ import annotations

import os
from pathlib import Path

import pytest

from somo_cli import files
from somo_cli.files import open_reference, read_text
from somo_cli.problems import InvalidFile, Problem, Span

ROOT = getattr(os, "geteuid", lambda: 1)() == 0
pytestmark = pytest.mark.usefixtures("narrow_umask")


# Reading


def test_a_text_is_read_without_its_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "f.yaml"
    path.write_bytes("\ufeffa: ü\r\n".encode())
    assert read_text(str(path)) == "a: ü\r\n"


@pytest.mark.parametrize(
    ("content", "span", "message", "hint"),
    [
        (
            b"a: 1\r\nb: \xc3\xbc \xe9\n",
            (2, 6),
            "byte 0xe9 at offset 12 is not UTF-8",
            "save the file as UTF-8",
        ),
        (
            b"\xef\xbb\xbfa\xff",
            (1, 2),
            "byte 0xff at offset 4 is not UTF-8",
            "save the file as UTF-8",
        ),
        (
            "a: 1\n".encode("utf-16"),
            (1, 1),
            f"byte 0x{'a: 1'.encode('utf-16')[0]:02x} at offset 0 is not UTF-8",
            "save the file as UTF-8, it looks like UTF-16",
        ),
        (b"a" * 1_000_001, (1, 1), "the file is larger than 1000000 bytes", ""),
    ],
)
def test_what_is_not_a_text_is_refused(
    tmp_path: Path, content: bytes, span: tuple[int, int], message: str, hint: str
) -> None:
    path = tmp_path / "f.yaml"
    path.write_bytes(content)
    with pytest.raises(InvalidFile) as caught:
        read_text(str(path))
    assert caught.value.problems == (Problem(Span(str(path), *span), message, hint),)


def test_a_file_that_cannot_be_read_raises(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_text(str(tmp_path / "none"))
    with pytest.raises(IsADirectoryError):
        read_text(str(tmp_path))


def test_an_endless_file_ends() -> None:
    with pytest.raises(InvalidFile):
        read_text("/dev/zero")


# References


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    (tmp_path / "in" / "deep").mkdir(parents=True)
    for name in ("out.yaml", "in/main.yaml", "in/a.yaml", "in/deep/b.yaml"):
        (tmp_path / name).write_text(f"name: {name}\n")
    (tmp_path / "in/link.yaml").symlink_to(tmp_path / "out.yaml")
    (tmp_path / "in/inner.yaml").symlink_to("deep/b.yaml")
    os.mkfifo(tmp_path / "in/pipe")
    return tmp_path


@pytest.mark.parametrize(
    ("naming", "reference", "source", "text"),
    [
        ("in/main.yaml", "a.yaml", "in/a.yaml", "name: in/a.yaml\n"),
        ("in/main.yaml", "./deep/b.yaml", "in/deep/b.yaml", "name: in/deep/b.yaml\n"),
        ("in/main.yaml", "deep/../a.yaml", "in/deep/../a.yaml", "name: in/a.yaml\n"),
        ("in/main.yaml", "inner.yaml", "in/inner.yaml", "name: in/deep/b.yaml\n"),
        ("--set 'base'", "out.yaml", "out.yaml", "name: out.yaml\n"),
    ],
)
def test_a_reference_is_relative_to_the_file_that_names_it(
    tree: Path,
    monkeypatch: pytest.MonkeyPatch,
    naming: str,
    reference: str,
    source: str,
    text: str,
) -> None:
    monkeypatch.chdir(tree)
    assert open_reference(naming, reference) == (source, text)


@pytest.mark.parametrize(
    ("reference", "reason"),
    [
        ("../out.yaml", "the path leads out of the folder"),
        ("deep/../../out.yaml", "the path leads out of the folder"),
        ("link.yaml", "the path leads out of the folder"),
        ("..", "the path leads out of the folder"),
        ("/etc/passwd", "the path must be relative"),
        ("\\\\server\\x", "the path must be relative"),
        ("~/x", "the path must be relative"),
        ("~root/x", "the path must be relative"),
        ("file:///etc/passwd", "a URL or a drive is not allowed"),
        ("https://example.org/x", "a URL or a drive is not allowed"),
        ("package://x/y", "a URL or a drive is not allowed"),
        ("C:\\x", "a URL or a drive is not allowed"),
        ("", "not the name of a file"),
        ("a\x00b", "not the name of a file"),
        ("a\nb", "not the name of a file"),
        ("pipe", "not a regular file"),
        (".", "not a regular file"),
        ("deep", "not a regular file"),
    ],
)
def test_a_reference_that_leaves_its_folder_is_refused(
    tree: Path, reference: str, reason: str
) -> None:
    with pytest.raises(ValueError, match=f"^{reason}"):
        open_reference(str(tree / "in/main.yaml"), reference)


@pytest.mark.parametrize("reference", ["../out.yaml", "link.yaml", "{tree}/out.yaml"])
def test_a_reference_may_lead_out_where_that_is_allowed(tree: Path, reference: str) -> None:
    path = reference.format(tree=tree)
    _, text = open_reference(str(tree / "in/main.yaml"), path, is_outside_allowed=True)
    assert text == "name: out.yaml\n"
    with pytest.raises(ValueError, match="not a regular file"):
        open_reference(str(tree / "in/main.yaml"), "../in", is_outside_allowed=True)
    with pytest.raises(ValueError, match="a URL or a drive"):
        open_reference(str(tree / "in/main.yaml"), "file:///x", is_outside_allowed=True)


def test_a_reference_may_lead_as_far_as_a_root(tree: Path) -> None:
    naming, root = str(tree / "in/deep/b.yaml"), str(tree / "in/main.yaml")
    assert open_reference(naming, "../a.yaml", root=root)[1] == "name: in/a.yaml\n"
    for reference in ("../../out.yaml", "../link.yaml"):
        with pytest.raises(ValueError, match="the path leads out of the folder"):
            open_reference(naming, reference, root=root)


def test_a_binary_file_keeps_its_bytes(tmp_path: Path) -> None:
    content = bytes(range(256)) + b"\xef\xbb\xbf"
    (tmp_path / "a.stl").write_bytes(content)
    _, text = open_reference(str(tmp_path / "a.yaml"), "a.stl", is_binary=True)
    assert text.encode("utf-8", "surrogateescape") == content
    with pytest.raises(InvalidFile, match="the file is larger than 258 bytes"):
        open_reference(str(tmp_path / "a.yaml"), "a.stl", largest=258, is_binary=True)


def test_a_reference_to_nothing_raises(tree: Path) -> None:
    with pytest.raises(FileNotFoundError):
        open_reference(str(tree / "in/main.yaml"), "none.yaml")


@pytest.mark.parametrize(
    ("path", "other", "named"),
    [
        ("a/scene.yaml", "a/rows.csv", "scene.yaml"),
        ("a/scene.yaml", "rows.csv", "a/scene.yaml"),
        ("scene.yaml", "a/b/rows.csv", "../../scene.yaml"),
    ],
)
def test_a_path_as_another_file_would_name_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str, other: str, named: str
) -> None:
    (tmp_path / "a/b").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    assert files.relative_path(path, other) == named
    assert files.relative_path(str(tmp_path / path), other) == named


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="there is no /dev/zero")
def test_what_has_no_end_is_read_in_part_only() -> None:
    with pytest.raises(InvalidFile, match="this is no text: it has zero bytes"):
        read_text("/dev/zero", 10**15)
