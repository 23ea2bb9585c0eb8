"""Mutations of the shipped files: each is valid or refused at a place, and nothing else happens.

`make fuzz` tries 50,000, and runs some of those that are valid.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.robustness.documents import Documents, faults_of
from tests.robustness.mutations import MUTATIONS, mutated

hypothesis = pytest.importorskip("hypothesis")
st = hypothesis.strategies


@pytest.fixture(scope="module")
def documents(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Documents]:
    """The shipped files in the current folder, without an engine: that is what takes the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "pybullet", None)
        found = Documents(tmp_path_factory.mktemp("documents") / "here")
        patch.chdir(found.folder)
        yield found


@pytest.mark.slow
@hypothesis.settings(
    max_examples=150,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=list(hypothesis.HealthCheck),
)
@hypothesis.given(data=st.data())
def test_a_mutated_file_is_valid_or_refused_at_a_place(documents: Documents, data: object) -> None:
    name = data.draw(st.sampled_from(sorted(documents.texts)), "file")  # type: ignore[attr-defined]
    chance = data.draw(st.randoms(use_true_random=False), "mutations")  # type: ignore[attr-defined]
    text = mutated(chance, documents.texts[name])
    reader = next(iter(documents.readers_of(name)), name)
    with documents.replaced(name, text):
        code, faults = faults_of("check", reader)
        assert faults == [], text
        if documents.kind(reader) == "definition":
            built, faults = faults_of("build", reader, "-q", "-o", "out.urdf")
            assert faults == [], text
            assert (built == 0) == (code == 0), text


def test_shipped_files_are_valid(documents: Documents) -> None:
    names = [name for name in documents.texts if name.endswith("finger.yaml")]
    assert [faults_of("check", name) for name in names] == [(0, [])] * len(names)


@pytest.mark.parametrize("mutation", MUTATIONS)
def test_every_mutation_changes_a_text_and_stands_an_empty_one(mutation: object) -> None:
    text = (Path(__file__).parents[1] / "definitions" / "finger.yaml").read_text("utf-8")
    changed = [mutation(random.Random(seed), text) != text for seed in range(20)]  # type: ignore[operator]
    assert sum(changed) > 5
    for small in ("", "\n", "a"):
        assert isinstance(mutation(random.Random(1), small), str)  # type: ignore[operator]


def test_what_is_wrong_is_seen(documents: Documents, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(path: str, *rest: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("somo_cli.loading.load", fail)
    code, faults = faults_of("check", "finger.yaml")
    assert (code, faults[:2]) == (-1, ["exit code -1", "'Traceback' in a message"])
