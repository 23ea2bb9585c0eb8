"""The pages of the manual: all listed, all linked rightly, all found."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from somo_cli.manual import search, topics
from tests.builders.command import Somo

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "somo_cli" / "manual" / "pages"


def test_every_page_is_a_topic_and_has_one_title() -> None:
    written = set(topics.TOPICS) - set(topics.GENERATED)
    assert {path.stem for path in PAGES.iterdir()} == written
    for topic in topics.TOPICS:
        text = re.sub(r"```.*?```", "", topics.page(topic), flags=re.DOTALL)
        assert len(re.findall(r"^# ", text, re.MULTILINE)) == 1, topic
        assert topics.page(topic).startswith("# "), topic


@pytest.mark.parametrize("path", [ROOT / "README.md", *PAGES.iterdir()], ids=lambda path: path.stem)
def test_every_link_leads_to_a_file_and_a_heading(path: Path) -> None:
    text = path.read_text("utf-8")
    for target in re.findall(r"\]\(([^)]+)\)", text):
        if target.startswith("http"):
            continue
        name, _, anchor = target.partition("#")
        aim = (path.parent / name).resolve() if name else path
        assert aim.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", aim.read_text("utf-8"), re.MULTILINE)
            assert anchor in [
                re.sub(r"[^\w -]", "", one.lower()).replace(" ", "-") for one in headings
            ]


def test_the_readme_links_every_page() -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    for topic, about in topics.TOPICS.items():
        link = f"[{topic}](somo_cli/manual/pages/{topic}.md)"
        name = f"`somo help {topic}`" if topic in topics.GENERATED else link
        assert f"- {name}: {about}\n" in readme


def test_a_page_is_plain_markdown_in_a_pipe(somo: Somo) -> None:
    shown = somo("help", "Contact")
    assert (shown.returncode, shown.stdout) == (0, topics.page("contact"))


def test_without_a_topic_all_are_listed(somo: Somo) -> None:
    shown = somo("help").stdout
    assert all(f"`somo help {topic}`" in shown for topic in topics.TOPICS)


def test_words_are_searched_in_all_pages(somo: Somo) -> None:
    shown = somo("help", "torque_per_pressure")
    assert shown.returncode == 0
    assert "somo help definitions\n  Definitions: " in shown.stdout
    found = search.matches(["contact", "STIFFNESS"])
    assert found
    assert all("contact" in one.line.lower() and "stiffness" in one.line.lower() for one in found)


def test_a_word_that_no_page_has_is_wrong_usage(somo: Somo) -> None:
    shown = somo("help", "flubber")
    assert (shown.returncode, shown.stdout) == (2, "")
    assert "no page of the manual has 'flubber'; the topics are tour, " in shown.stderr
