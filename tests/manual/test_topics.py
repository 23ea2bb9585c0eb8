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


@pytest.mark.slow
def test_the_design_page_leads_to_a_gripper_that_lifts(somo: Somo, tmp_path: Path) -> None:
    text = topics.page("design")
    (begin,) = re.findall(r"^    (somo new .*)$", text, re.MULTILINE)
    assert somo(*begin.split()[1:]).returncode == 0
    shown = somo("show", "mine_finger.yaml").stdout
    assert "0.02669 kg" in shown
    assert "each 0.08437 N·m/rad (0.02109 in series)" in shown
    assert "slowest modes: 4.786" in shown
    judged = somo("run", "mine_scene.yaml", "--error", "--strict")
    assert judged.returncode == 0
    assert judged.stderr.splitlines()[-1] == "converged to 0.62 %"
    (study,) = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "vary.yaml").write_text(study, "utf-8")
    swept = somo("sweep", "vary.yaml", "-j", "2", "--best", "grip", "--where", "held")
    assert swept.returncode == 0
    held = [line.split() for line in swept.stdout.splitlines()[1:]]
    assert len(held) == 7
    assert all(float(row[3]) == pytest.approx(0.0758, abs=1e-3) for row in held)
