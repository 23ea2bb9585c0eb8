"""The names that parameters and labels of a study may have."""

from __future__ import annotations

from collections.abc import Iterator

from somo_cli.document.parse import Document
from somo_cli.problems import Pointer, Problem
from somo_cli.sweep.expressions import CONSTANTS, FUNCTIONS
from somo_cli.sweep.reductions import REDUCTIONS
from somo_cli.sweep.study import OUTCOME

RESERVED = {"run", *OUTCOME}
"""Names of columns of the table of results that no parameter and no label may have."""
WORDS = {*FUNCTIONS, *REDUCTIONS, *CONSTANTS, "and", "or", "not", "if", "else", "in", "is"}
"""Words of expressions, which name no parameter and no label."""


def name_problems(document: Document, pointer: Pointer) -> Iterator[Problem]:
    """Yield a problem for a name that the table or the expressions use otherwise."""
    name = str(pointer[-1])
    place = document.span(pointer, key=True)
    if name in RESERVED:
        yield Problem(place, f"'{name}' is a column of the table of results", "take another name")
    elif name in WORDS:
        yield Problem(place, f"'{name}' is a word of expressions", "take another name")
