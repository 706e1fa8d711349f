"""The arrays of records, copied one after the other, and the addresses that point to them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..solver.compiler.struct import Struct
from .variables import Variable

CONSTANT_SEGMENT, LIVE_SEGMENT = 0, 1
# That of the caches of processors; small arrays would waste most of it.
ARRAY_ALIGNMENT, WORD_BYTES = 64, 8
Offset = tuple[int, int]
"""segment and offset"""


class Segments:
    """Copies of arrays in two blocks: those that no step changes, and the live ones."""

    def __init__(self) -> None:
        self.blocks = [bytearray(), bytearray()]
        self.words: list[np.ndarray[Any, Any]] = []
        self.relocations: list[tuple[int, int, int]] = []
        self._n_words = 0
        self._at: dict[tuple[int, int], tuple[int, Offset]] = {}
        """size and place of the arrays, by address and segment"""

    def add(self, record: Struct, live: Sequence[str]) -> int:
        """Add a record, whose fields of these names are live; the first of its words."""
        first = self._n_words
        words = record.words.copy()
        for name, (at, _) in type(record).layout.items():
            value = getattr(record, name)
            # The data of a model are shared by all instances of an export.
            segment = LIVE_SEGMENT if name in live else CONSTANT_SEGMENT
            pointers = value.pointers(at) if isinstance(value, Struct) else [(at, value)]
            for word, array in pointers:
                if isinstance(array, np.ndarray):
                    self.relocations.append((first + word, *self._put(array, segment)))
                    # An address of this process has no meaning in the next.
                    words[word] = 0
        self.words.append(words)
        self._n_words += len(words)
        return first

    def _put(self, array: np.ndarray[Any, Any], segment: int) -> Offset:
        address = array.__array_interface__["data"][0]
        key = address, segment
        # Records share arrays: what is one here must be one there.
        if array.nbytes and key in self._at:
            return self._at[key][1]
        # At multiples of the alignment, or vector loads would be slower.
        block = self.blocks[segment]
        block += bytes(
            -len(block) % (ARRAY_ALIGNMENT if array.nbytes >= ARRAY_ALIGNMENT else WORD_BYTES)
        )
        place = segment, len(block)
        block += array.tobytes()
        if array.nbytes:
            # Arrays without numbers have addresses that others may have too.
            self._at[key] = array.nbytes, place
        return place

    def place(self, view: np.ndarray[Any, Any]) -> Offset:
        """Where a view into one of the arrays is."""
        address = view.__array_interface__["data"][0]
        for (start, _), (size, (segment, offset)) in self._at.items():
            if start <= address < start + size:
                return segment, offset + address - start
        raise LookupError("no array of the model holds this view")

    def offset(self, variable: Variable) -> int:
        """The offset of an output or a parameter in its segment."""
        assert variable.place is not None
        return self.place(variable.place)[1]

    def live(self, view: np.ndarray[Any, Any]) -> int:
        """The offset of a view in its segment; 0 of one without numbers, which nobody reads."""
        return self.place(view)[1] if view.size else 0
