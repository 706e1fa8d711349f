"""The arrays of a model as one block of bytes that a program without Python relocates and steps.

    header | words of records | relocations | constant arrays | live arrays at t = 0 | ...

The C code reads it (fmu/c/image.h, which names all parts of it and is read here as well). It holds
no address: the word of each address is zero, and is listed with the segment and the offset of what
it points to. Words are of 8 bytes and little-endian, and arrays have the same layout on all
platforms, so that one image serves them all.
"""

import hashlib
import re
import struct
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..results.validity import CRITERIA
from ..solver.arrays import Array
from ..solver.compiler.struct import Struct
from ..solver.history.dyadic import Window
from ..solver.output.branches import Branches
from ..solver.output.passages import MOST_CREATED
from ..solver.signals.curves import Input
from ..solver.simulation import signals
from ..solver.stepper import Stepper
from .variables import Kind, Variable

MAGIC, VERSION = b"DUHAMEL\0", 1
CONSTANT_SEGMENT, LIVE_SEGMENT = 0, 1
ALIGNMENT = 64
Place = tuple[int, int]
"""segment and offset"""


@cache
def names_of(kind: str) -> tuple[str, ...]:
    """The names of an enumeration in fmu/c/image.h, in lower case, but for the count at its end."""
    text = Path(__file__).with_name("c").joinpath("image.h").read_text(encoding="utf-8")
    found = re.search(rf"enum {kind} {{(.*?)}}", re.sub(r"/\*.*?\*/", "", text, flags=re.S), re.S)
    assert found is not None
    return tuple(name.lower() for name in re.findall(r"\w+", found[1])[:-1])


class _Segments:
    """The arrays of records, copied one after the other, with the addresses that point to them."""

    def __init__(self) -> None:
        self.blocks = [bytearray(), bytearray()]
        self.words: list[np.ndarray[Any, Any]] = []
        self.relocations: list[tuple[int, int, int]] = []
        self._n_words = 0
        self._at: dict[tuple[int, int], tuple[int, Place]] = {}
        """size and place of the arrays, by address and segment"""

    def add(self, record: Struct, live: Sequence[str]) -> int:
        """Add a record, whose fields of these names are live; the first of its words."""
        first = self._n_words
        words = record.words.copy()
        for name, (at, _) in type(record).layout.items():
            value = getattr(record, name)
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

    def _put(self, array: np.ndarray[Any, Any], segment: int) -> Place:
        address = array.__array_interface__["data"][0]
        key = address, segment
        if array.nbytes and key in self._at:
            return self._at[key][1]
        block = self.blocks[segment]
        block += bytes(-len(block) % (ALIGNMENT if array.nbytes >= ALIGNMENT else 8))
        place = segment, len(block)
        block += array.tobytes()
        if array.nbytes:
            self._at[key] = array.nbytes, place
        return place

    def place(self, view: np.ndarray[Any, Any]) -> Place:
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
        """The offset of a view of a live array; 0 of one without numbers."""
        return self.place(view)[1] if view.size else 0


def image_of(stepper: Stepper, variables: Sequence[Variable]) -> bytes:
    """The image of a model before its first step is prepared, with its variables."""
    segments = _Segments()
    run, lowered, state, work = stepper.run, stepper.lowered, stepper.run.state, stepper.run.work
    word_of_run = segments.add(run, ("state", "work", "output"))
    assert word_of_run == 0
    live = ("load", "drive", "motor", "row")
    word_of_inputs = segments.add(stepper.inputs, live)
    word_of_no_step = segments.add(stepper.first, live)
    removed = stepper.initial.removed
    whole = removed.lowered.system.couplings
    word_of_removed = segments.add(whole.rows, ()) if removed.rows else 0
    n_rows = len(lowered.system.couplings.compliant)
    table, columns = _signals(stepper, segments)
    texts = _Texts()
    contacts = [
        *(lowered.model.couplings[j].owner for j in lowered.system.couplings.contact),
        *(f"contact {contact.name!r}" for contact in lowered.model.surface_contacts),
    ]
    words_of = {name: first for name, (first, _) in type(run).layout.items()}
    couplings = type(run.system).layout["couplings"][0]
    kernels = lowered.system.elastic.kernels
    past = Window(lowered.system.elastic).span if kernels.lags.any() else 0
    criterion = CRITERIA["surface_steps"]
    has_end = bool(columns) or bool(kernels.lags.any())
    numbers: dict[str, int | float] = {
        "word_of_work": words_of["work"],
        "word_of_couplings": words_of["system"] + couplings,
        "word_of_inputs": word_of_inputs,
        "word_of_no_step": word_of_no_step,
        "word_of_removed_rows": word_of_removed,
        "place_of_left": segments.live(state.extremes.left),
        "place_of_passed": segments.live(state.contacts.passed),
        "place_of_n_events": segments.live(state.contacts.n_events),
        "place_of_row": segments.live(stepper.inputs.row),
        "place_of_current": segments.live(work.matrix.current),
        "place_of_phi": segments.live(work.couplings.phi),
        "place_of_compliant": segments.live(lowered.system.couplings.compliant),
        "place_of_shortest": segments.live(state.extremes.shortest),
        "place_of_switching": segments.live(state.energies.switching),
        "place_of_moved": segments.live(state.extremes.moved),
        "place_of_first": segments.live(state.past.first),
        "place_of_p": segments.live(state.past.p),
        "place_of_u_ahead": segments.live(state.past.u_ahead),
        "n_inputs": len(stepper.input_names),
        "n_rows": n_rows,
        "n_coupled_contacts": len(lowered.system.couplings.contact),
        "n_contacts": len(contacts),
        "n_steps": lowered.n_steps if has_end else 0,
        "n_past": state.past.p.shape[1],
        "n_dofs": state.past.p.shape[0],
        "span": past,
        "step": float(lowered.h),
        "tolerance": float(lowered.model.settings.tolerance),
        "end": float(lowered.n_steps * lowered.h),
        "most_created": MOST_CREATED,
        "few_steps": float(criterion.limit),
        "good_steps": float(criterion.good),
    }
    pieces: dict[str, Any] = {
        "piece_words": np.concatenate(segments.words),
        "piece_relocations": _index(segments.relocations),
        "piece_constant": segments.blocks[CONSTANT_SEGMENT],
        "piece_live": segments.blocks[LIVE_SEGMENT],
        "piece_signals": table,
        "piece_signal_places": _index(columns),
        "piece_variables": _index(_places(variables, segments)),
        "piece_parameters": _index(
            [segments.offset(one) for one in variables if one.kind is Kind.PARAMETER]
        ),
        "piece_inputs": _index(
            [
                (stepper.input_names.index(signal.name), segments.live(place))
                for place, signal in stepper.signals
                if isinstance(signal, Input)
            ]
        ),
        "piece_branches": Branches(lowered).rows,
        "piece_removed": _index(removed.rows),
        "piece_removed_limits": removed.limits,
        "piece_frames": texts.add(lowered.frame_names),
        "piece_rows": texts.add(map(lowered.owner_of, range(n_rows))),
        "piece_contacts": texts.add(contacts),
        "piece_removed_names": texts.add(map(removed.lowered.owner_of, removed.rows)),
    }
    pieces["piece_texts"] = texts.text
    return _joined(pieces, numbers)


class _Texts:
    """Texts one after the other, each ended by a zero."""

    def __init__(self) -> None:
        self.text = bytearray()

    def add(self, names: Iterable[str]) -> np.ndarray[Any, Any]:
        """Add texts; where each begins."""
        places = []
        for name in names:
            places.append(len(self.text))
            self.text += name.encode() + b"\0"
        return _index(places)


def _index(numbers: Any) -> np.ndarray[Any, Any]:
    return np.array(numbers, dtype=np.int64)


def _places(variables: Sequence[Variable], segments: _Segments) -> list[tuple[int, int]]:
    """Kind and place of each variable: its offset, or its number among inputs or parameters."""
    places, counts = [], dict.fromkeys(Kind, 0)
    for one in variables:
        at = segments.offset(one) if one.is_output else counts[one.kind]
        places.append((int(one.kind), at))
        counts[one.kind] += 1
    return places


def _signals(stepper: Stepper, segments: _Segments) -> tuple[Array, list[int]]:
    """Signals that are no inputs: their values at all steps (n, k), and where each of k goes.

    Those that never change are put into the image at once, and have no column.
    """
    lowered = stepper.lowered
    sampled = signals(lowered, 1, np.zeros(lowered.n_steps, dtype=np.int64))
    values = np.concatenate([sampled.load, sampled.drive, sampled.motor], axis=1)
    columns, places = list[Array](), list[int]()
    for (place, signal), column in zip(stepper.signals, values.T, strict=True):
        at = segments.live(place)
        value = signal.value if isinstance(signal, Input) else column[0]
        struct.pack_into("<d", segments.blocks[LIVE_SEGMENT], at, value)
        if not isinstance(signal, Input) and (column != column[0]).any():
            columns.append(column)
            places.append(at)
    return np.array(columns).reshape(len(columns), lowered.n_steps).T.copy(), places


def _joined(pieces: dict[str, Any], numbers: dict[str, int | float]) -> bytes:
    """The image, with its digest in the header."""
    assert tuple(pieces) == names_of("Piece")
    assert tuple(numbers) == names_of("Number")
    header = np.zeros(8 + 2 * len(pieces) + len(numbers), dtype=np.int64)
    body, start = bytearray(), -(-header.nbytes // ALIGNMENT) * ALIGNMENT
    for k, piece in enumerate(pieces.values()):
        content = bytes(piece) if isinstance(piece, bytearray) else piece.tobytes()
        body += bytes(-len(body) % ALIGNMENT)
        header[8 + 2 * k : 10 + 2 * k] = start + len(body), len(content)
        body += content
    for k, number in enumerate(numbers.values()):
        bits = np.float64(number).view(np.int64) if isinstance(number, float) else number
        header[8 + 2 * len(pieces) + k] = bits
    header[:3] = np.frombuffer(MAGIC, np.int64)[0], VERSION, start + len(body)
    image = header.tobytes().ljust(start, b"\0") + bytes(body)
    header[4:8] = np.frombuffer(hashlib.sha256(image).digest(), dtype=np.int64)
    return header.tobytes() + image[header.nbytes :]


def token_of(image: bytes) -> str:
    """The digest of an image, by which importers name the export."""
    return image[32:64].hex()
