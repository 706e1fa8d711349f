"""Elements of a robot's XML with their place in words, and their attributes as numbers."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ..files.arrays import Array
from ..inputs import quoted
from .errors import RobotError


@dataclass
class LeftOut:
    """What nobody reads of a file, counted by what it is."""

    counts: Counter[str] = field(default_factory=Counter)
    remarks: list[str] = field(default_factory=list)

    def lines(self) -> tuple[str, ...]:
        """What was counted, then all remarks."""
        return (*self.counts.elements(), *self.remarks)


@dataclass(frozen=True)
class Node:
    """An element, with what messages call it: the joint 'elbow', its limit, ...

    known: the attributes and elements that somebody reads; silent: those that mean nothing to a
    model. All others are left out, and counted.
    """

    element: Element
    path: Path
    where: str
    left_out: LeftOut

    def error(self, message: str) -> RobotError:
        return RobotError(f"{self.path}: {self.where}: {message}")

    def reads(
        self,
        attributes: Sequence[str] = (),
        elements: Sequence[str] = (),
        silent: Sequence[str] = (),
    ) -> "Node":
        """This node, once what nobody reads of it is counted."""
        for name in self.element.attrib:
            if name not in attributes and name not in silent and ":" not in name:
                self.left_out.counts[f"attribute {name!r} of <{self.element.tag}>"] += 1
        for child in self.element:
            if child.tag not in elements and child.tag not in silent:
                self.left_out.counts[f"<{child.tag}> of <{self.element.tag}>"] += 1
        return self

    def child(self, tag: str) -> "Node | None":
        """The only element of a tag; None where there is none."""
        found = self.element.findall(tag)
        if len(found) > 1:
            raise self.error(f"expected one <{tag}>, found {len(found)}")
        return self._of(found[0], f"{self.where}: {tag}") if found else None

    def needed(self, tag: str) -> "Node":
        """The only element of a tag, which must be there."""
        found = self.child(tag)
        if found is None:
            raise self.error(f"expected <{tag}>, found none")
        return found

    def named(self, tag: str) -> Iterator["Node"]:
        """All elements of a tag, each with a name of its own."""
        seen = set[str]()
        for element in self.element.findall(tag):
            name = element.get("name", "")
            if not name.strip():
                raise self.error(f"expected a name of each <{tag}>, found one without")
            if name in seen:
                raise self.error(f"expected different names, found two <{tag}> called {name!r}")
            seen.add(name)
            yield self._of(element, f"{tag} {name!r}")

    def each(self, tag: str) -> Iterator["Node"]:
        """All elements of a tag."""
        for element in self.element.findall(tag):
            yield self._of(element, f"{self.where}: {tag}")

    @property
    def name(self) -> str:
        return self.element.get("name", "")

    def word(self, key: str) -> str:
        """An attribute that must be there."""
        value = self.element.get(key, "").strip()
        if not value:
            raise self.error(f"{key}: expected text, found none")
        return value

    def number(self, key: str, default: float | None = None, *, infinite: bool = False) -> float:
        """An attribute that is a number; without a default it must be there."""
        if key not in self.element.attrib and default is not None:
            return default
        (number,) = self.numbers(key, 1, infinite=infinite)
        return float(number)

    def numbers(
        self, key: str, n: int, default: Sequence[float] | None = None, *, infinite: bool = False
    ) -> Array:
        """An attribute of n numbers, with blanks between them."""
        text = self.element.get(key)
        if text is None and default is not None:
            return np.array(default, dtype=float)
        words = "" if text is None else text
        values = [_number(word) for word in words.split()]
        fine = all(
            value is not None and (infinite or math.isfinite(value)) and not math.isnan(value)
            for value in values
        )
        if len(values) != n or not fine:
            expected = "a number" if n == 1 else f"{n} numbers"
            found = "none" if text is None else quoted(text)
            raise self.error(f"{key}: expected {expected}, got {found}")
        return np.array(values, dtype=float)

    def _of(self, element: Element, where: str) -> "Node":
        return Node(element, self.path, where, self.left_out)


def _number(word: str) -> float | None:
    # Python takes 1_000 for a number; other readers of robots do not.
    if "_" in word:
        return None
    try:
        return float(word)
    except ValueError:
        return None
