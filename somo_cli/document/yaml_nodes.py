"""YAML text to PyYAML's node graph, limited in depth and in the number of values."""

from __future__ import annotations

from typing import Any

from yaml.composer import Composer
from yaml.error import Mark, MarkedYAMLError
from yaml.events import AliasEvent, CollectionStartEvent, StreamEndEvent
from yaml.nodes import Node, ScalarNode
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.resolver import Resolver
from yaml.scanner import Scanner

MAX_DEPTH = 50
MAX_VALUES = 200_000

PLAIN = "plain"
"""The tag of a scalar that was written without quotes and without a tag."""

UNTAGGED = ""
"""The tag of every other node that was written without a tag."""


class NodeComposer(Reader, Scanner, Parser, Composer, Resolver):
    """Makes the node graph of a text with PyYAML, within limits.

    Scalars keep their text: PyYAML would read numbers and words by YAML 1.1.
    """

    def __init__(self, text: str) -> None:
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        Composer.__init__(self)
        Resolver.__init__(self)
        self._depth = 0  # enclosing collections
        self._reached = 0  # the greatest depth so far, with aliases expanded
        self._count = 0  # values so far, with aliases expanded
        self._extent: dict[int, tuple[int, int]] = {}  # node id: values, height

    def compose_one(self) -> tuple[Node | None, Mark | None]:
        """Return the root node, and the mark where a second document starts, None if none does."""
        self.get_event()  # type: ignore[no-untyped-call]
        if self.check_event(StreamEndEvent):
            return None, None
        root: Node | None = self.compose_document()
        if isinstance(root, ScalarNode) and root.tag == PLAIN and root.value == "":
            root = None
        if self.check_event(StreamEndEvent):
            return root, None
        following: Any = self.peek_event()  # type: ignore[no-untyped-call]
        return root, following.start_mark

    def resolve(self, kind: type[Node], value: object, implicit: object) -> str:
        """Return PLAIN or UNTAGGED, in place of the tags of YAML 1.1."""
        plain = kind is ScalarNode and isinstance(implicit, tuple) and implicit[0]
        return PLAIN if plain else UNTAGGED

    def compose_node(self, parent: Node | None, index: Any) -> Node | None:
        """Return the next node; raise MarkedYAMLError where it exceeds a limit."""
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, AliasEvent):
            node: Node | None = super().compose_node(parent, index)
            if id(node) not in self._extent:
                self._refuse(event, f"alias '*{event.anchor}' contains itself")
            count, height = self._extent[id(node)]
            self._grow(event, count, height)
            self._reached = max(self._reached, self._depth + height)
            return node
        height = int(isinstance(event, CollectionStartEvent))
        self._grow(event, 1, height)
        before, outer = self._count - 1, self._reached
        self._depth += height
        self._reached = self._depth
        node = super().compose_node(parent, index)
        self._depth -= height
        self._extent[id(node)] = (self._count - before, self._reached - self._depth)
        self._reached = max(outer, self._reached)
        return node

    def _grow(self, event: Any, count: int, height: int) -> None:
        self._count += count
        if self._count > MAX_VALUES:
            self._refuse(event, f"more than {MAX_VALUES} values, with aliases expanded")
        if self._depth + height > MAX_DEPTH:
            self._refuse(event, f"nested more than {MAX_DEPTH} deep")

    def _refuse(self, event: Any, message: str) -> None:
        raise MarkedYAMLError(problem=message, problem_mark=event.start_mark)
