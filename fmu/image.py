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
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..results.criteria import CRITERIA
from ..solver.arrays import Array
from ..solver.compiler.digests import key
from ..solver.history.dyadic import Window
from ..solver.output.branches import Branches
from ..solver.output.passages import MOST_CREATED
from ..solver.phases import Corners
from ..solver.signals.curves import Input
from ..solver.simulation import signals
from ..solver.stepper import Stepper
from .segments import ARRAY_ALIGNMENT, CONSTANT_SEGMENT, LIVE_SEGMENT, Segments
from .variables import Variable, VariableKind

IMAGE_MAGIC, IMAGE_VERSION = b"DUHAMEL\0", 1
DIGEST_AT, PIECES_AT = 4, 8
"""words of the header"""


@cache
def enumerated(kind: str) -> tuple[str, ...]:
    """The names of an enumeration in fmu/c/image.h, in lower case, but for the count at its end."""
    text = Path(__file__).with_name("c").joinpath("image.h").read_text(encoding="utf-8")
    found = re.search(rf"enum {kind} {{(.*?)}}", re.sub(r"/\*.*?\*/", "", text, flags=re.S), re.S)
    assert found is not None
    return tuple(name.lower() for name in re.findall(r"\w+", found[1])[:-1])


def image_of(stepper: Stepper, variables: Sequence[Variable]) -> bytes:
    """The image of a model before its first step is prepared, with its variables."""
    segments, removed = Segments(), stepper.initial.removed
    live = ("load", "drive", "motor", "row")
    words = {
        "run": segments.add(stepper.run, ("state", "work", "output")),
        # Arrays of both sizes of steps are one where the runs share them.
        "flight": segments.add(stepper.flight or stepper.run, ("state", "work", "output")),
        "inputs": segments.add(stepper.inputs, live),
        "no_step": segments.add(stepper.first, live),
        # Rows that were left out are those of the model with all its constraints.
        "removed_rows": segments.add(removed.lowered.system.couplings.rows, ()),
    }
    # Before the pieces: it writes what never changes into the live arrays.
    table, columns = _signals(stepper, segments)
    numbers = _words(stepper, words) | _places(stepper, segments) | _sizes(stepper)
    numbers |= _limits(stepper, has_signals=bool(columns))
    pieces: dict[str, Any] = {
        "piece_words": np.concatenate(segments.words),
        "piece_relocations": _index(segments.relocations),
        "piece_constant": segments.blocks[CONSTANT_SEGMENT],
        "piece_live": segments.blocks[LIVE_SEGMENT],
        "piece_signals": table,
        "piece_signal_places": _index(columns),
        "piece_variables": _index(_variables(variables, segments)),
        "piece_parameters": _index(
            [segments.offset(one) for one in variables if one.kind is VariableKind.PARAMETER]
        ),
        "piece_inputs": _index(
            [
                (stepper.input_names.index(signal.name), segments.live(place))
                for place, signal in stepper.signals
                if isinstance(signal, Input)
            ]
        ),
        "piece_branches": Branches(stepper.lowered).rows,
        "piece_short": Corners(stepper.lowered).refused(),
        "piece_removed": _index(removed.rows),
        "piece_removed_limits": removed.limits,
    }
    return _joined(pieces | _texts(stepper), numbers)


def _words(stepper: Stepper, words: dict[str, int]) -> dict[str, float]:
    """Where the records that compiled functions take begin."""
    of_run = {name: words["run"] + first for name, (first, _) in type(stepper.run).layout.items()}
    couplings, _ = type(stepper.run.system).layout["couplings"]
    return {
        "word_of_flight": words["flight"],
        "word_of_flying_system": words["flight"] + of_run["system"] - words["run"],
        "word_of_system": of_run["system"],
        "word_of_state": of_run["state"],
        "word_of_work": of_run["work"],
        "word_of_couplings": of_run["system"] + couplings,
        "word_of_inputs": words["inputs"],
        "word_of_no_step": words["no_step"],
        "word_of_removed_rows": words["removed_rows"],
    }


def _places(stepper: Stepper, segments: Segments) -> dict[str, float]:
    """Where the arrays are that the C code reads and sets itself."""
    state, work = stepper.run.state, stepper.run.work
    arrays = {
        "in_flight": state.in_flight,
        "left": state.extremes.left,
        "passed": state.contacts.passed,
        "n_events": state.contacts.n_events,
        "row": stepper.inputs.row,
        "current": work.matrix.current,
        "phi": work.couplings.phi,
        "compliant": stepper.lowered.system.couplings.compliant,
        "shortest": state.extremes.shortest,
        "switching": state.energies.switching,
        "moved": state.extremes.moved,
        "first": state.past.first,
        "p": state.past.p,
        "u_ahead": state.past.u_ahead,
    }
    return {f"place_of_{name}": segments.live(array) for name, array in arrays.items()}


def _sizes(stepper: Stepper) -> dict[str, float]:
    couplings, past = stepper.lowered.system.couplings, stepper.run.state.past
    return {
        "n_inputs": len(stepper.input_names),
        "n_rows": len(couplings.compliant),
        "n_coupled_contacts": len(couplings.contact),
        "n_contacts": len(couplings.contact) + len(stepper.lowered.model.surface_contacts),
        "n_dofs": past.p.shape[0],
        "n_past": past.p.shape[1],
    }


def _limits(stepper: Stepper, has_signals: bool) -> dict[str, float]:
    """Steps and tolerances; n_steps is 0 where nothing ends with the model."""
    lowered = stepper.lowered
    has_kernels = bool(lowered.system.elastic.kernels.lags.any())
    steps = CRITERIA["surface_steps"]
    return {
        # Kernels were cut at the end of the model.
        "n_steps": lowered.n_steps if has_signals or has_kernels else 0,
        "ratio": lowered.ratio,
        "span": Window(lowered.system.elastic).span if has_kernels else 0,
        "step": float(lowered.longest_step),
        "tolerance": float(lowered.model.settings.tolerance),
        "end": float(lowered.n_steps * lowered.h),
        "most_created": float(MOST_CREATED),
        "few_steps": float(steps.limit),
        "good_steps": float(steps.good),
    }


def _texts(stepper: Stepper) -> dict[str, Any]:
    """The names that messages use, each ended by a zero, and where those of each kind begin."""
    lowered, removed = stepper.lowered, stepper.initial.removed
    couplings = lowered.system.couplings
    names: dict[str, list[str]] = {
        "piece_frames": lowered.frame_names,
        "piece_rows": [lowered.owner_of(i) for i in range(len(couplings.compliant))],
        "piece_contacts": [
            *(lowered.model.couplings[j].owner for j in couplings.contact),
            # They are no couplings, and follow these in the state.
            *(f"contact {contact.name!r}" for contact in lowered.model.surface_contacts),
        ],
        "piece_removed_names": [removed.lowered.owner_of(i) for i in removed.rows],
    }
    text, pieces = bytearray(), dict[str, Any]()
    for piece, entries in names.items():
        starts = []
        for name in entries:
            starts.append(len(text))
            text += name.encode() + b"\0"
        pieces[piece] = _index(starts)
    return pieces | {"piece_texts": text}


def _index(numbers: Any) -> np.ndarray[Any, Any]:
    return np.array(numbers, dtype=np.int64)


def _variables(variables: Sequence[Variable], segments: Segments) -> list[tuple[int, int]]:
    """Kind and place of each variable: an offset, or a number among inputs or parameters."""
    places, counts = [], dict.fromkeys(VariableKind, 0)
    for one in variables:
        at = segments.offset(one) if one.is_output else counts[one.kind]
        places.append((int(one.kind), at))
        counts[one.kind] += 1
    return places


def _signals(stepper: Stepper, segments: Segments) -> tuple[Array, list[int]]:
    """Signals that are no inputs: their values at all steps (n, k), and where each of k goes.

    Those that never change are put into the image at once, and have no column.
    """
    lowered = stepper.lowered
    sampled = signals(lowered, 1, np.zeros(lowered.n_steps, dtype=np.int64))
    values = np.concatenate([sampled.load, sampled.drive, sampled.motor], axis=1)
    columns, places = list[Array](), list[int]()
    for (place, signal), column in zip(stepper.signals, values.T, strict=True):
        at = segments.live(place)
        # Of an input the start, from which its first step goes on.
        value = signal.value if isinstance(signal, Input) else column[0]
        struct.pack_into("<d", segments.blocks[LIVE_SEGMENT], at, value)
        if not isinstance(signal, Input) and (column != column[0]).any():
            columns.append(column)
            places.append(at)
    return np.array(columns).reshape(len(columns), lowered.n_steps).T.copy(), places


def _joined(pieces: dict[str, Any], numbers: dict[str, float]) -> bytes:
    """The image, with its digest in the header."""
    # As the C code counts them.
    assert tuple(pieces) == enumerated("Piece")
    assert tuple(numbers) == enumerated("Number")
    header = np.zeros(PIECES_AT + 2 * len(pieces) + len(numbers), dtype=np.int64)
    body, start = bytearray(), -(-header.nbytes // ARRAY_ALIGNMENT) * ARRAY_ALIGNMENT
    for k, piece in enumerate(pieces.values()):
        content = bytes(piece) if isinstance(piece, bytearray) else piece.tobytes()
        body += bytes(-len(body) % ARRAY_ALIGNMENT)
        at = PIECES_AT + 2 * k
        header[at : at + 2] = start + len(body), len(content)
        body += content
    for k, number in enumerate(numbers.values()):
        # Doubles by their bits: a header has words of one kind.
        bits = np.float64(number).view(np.int64) if isinstance(number, float) else number
        header[PIECES_AT + 2 * len(pieces) + k] = bits
    header[:3] = np.frombuffer(IMAGE_MAGIC, np.int64)[0], IMAGE_VERSION, start + len(body)
    image = header.tobytes().ljust(start, b"\0") + bytes(body)
    # Of the code too: a state of another version of Duhamel would be refused by nothing else.
    digest = hashlib.sha256(image + key("x86_64-linux").encode()).digest()
    header[DIGEST_AT : DIGEST_AT + 4] = np.frombuffer(digest, dtype=np.int64)
    return header.tobytes() + image[header.nbytes :]


def token_of(image: bytes) -> str:
    """The digest of an image, by which importers name the export."""
    return image[8 * DIGEST_AT : 8 * DIGEST_AT + 32].hex()
