"""Frequency responses in Universal File Format: sets 58 and 58b, by pyuff.

Source: Universal File Datasets Summary, University of Cincinnati, dataset 58.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...files.arrays import Array, Complex
from ..errors import MeasurementError, about
from .channels import ChannelTable
from .hits import HitTable
from .impulse_data import from_the_hit, transformed

QUANTITY_OF_TYPE = {12: "accelerance", 11: "mobility", 8: "receptance"}
"""of UFF's types of the numerator"""
FORCE_TYPE, FREQUENCY_TYPE = 13, 18
"""of UFF: its denominator and its abscissa"""
TIME_TYPE, ACCELERATION_TYPE = 17, 12
"""of UFF: the abscissa of a record, and what an impulse response is per force"""
RESPONSE_FUNCTION, COHERENCE_FUNCTION = 4, 6
"""of UFF: its functions"""
TIME_FUNCTIONS = 0, 1
"""of UFF: general ones and time responses, which impulse responses are written as"""
NumberedSet = tuple[int, Mapping[str, Any]]
SAME_LINES = 1e-6
"""relative difference of frequencies that are one line"""


@dataclass(frozen=True, eq=False)
class UffResponses:
    """f (k,) [Hz], H (k, n_o, n_i), what they are per force, "" if not told, and coherences.

    What was written over time is transformed; its quantity is "impulse".
    """

    f: Array
    H: Complex
    quantity: str
    coherence: Array | None


def read_uff(
    path: Path, channels: ChannelTable, hits: HitTable, over_time: bool = False
) -> UffResponses:
    """The responses of a file, and coherences where it has some.

    over_time: its time records are meant, and are impulse responses even if they do not say that
    they are per force. Without frequency responses records are taken that do say so.

    `MeasurementError` names the file, the set, what was found and what was expected.
    """
    pyuff = pyuff_module(path, "reading")
    # pyuff raises plain exceptions.
    with about(path, MeasurementError, "file", "not a readable UFF file", (Exception,)):
        file = pyuff.UFF(str(path))
        types = [int(kind) for kind in file.get_set_types()]
        sets = [(k + 1, file.read_sets(k)) for k, kind in enumerate(types) if kind == 58]
    # pyuff passes over what it cannot read, and says nothing.
    if 0 in types:
        raise MeasurementError(f"{path}: set {types.index(0) + 1}: expected a UFF set, found none")
    responses = [(k, one) for k, one in sets if _is_response(path, k, one)]
    records = [(k, one) for k, one in sets if _is_over_time(one)]
    if records and (over_time or not responses):
        return _of_records(path, records, over_time, channels, hits)
    if not responses:
        raise MeasurementError(
            f"{path}: expected sets 58 of frequency or impulse responses, found none"
        )
    # All of them have one axis, or could not be one matrix.
    first = np.asarray(responses[0][1]["x"], dtype=float)
    H = _matrix(path, responses, first, channels, hits)
    coherent = [(k, one) for k, one in sets if int(one["func_type"]) == COHERENCE_FUNCTION]
    # A coherence has no direction.
    coherence = np.abs(_matrix(path, coherent, first, channels, hits)) if coherent else None
    quantities = {
        QUANTITY_OF_TYPE.get(int(one["ordinate_spec_data_type"]), "") for _, one in responses
    }
    if len(quantities) > 1:
        raise MeasurementError(f"{path}: expected one quantity, found {sorted(quantities)}")
    return UffResponses(first, H, quantities.pop(), coherence)


def _of_records(
    path: Path,
    records: list[NumberedSet],
    over_time: bool,
    channels: ChannelTable,
    hits: HitTable,
) -> UffResponses:
    """Impulse responses; `MeasurementError` names the first set that is none."""
    for k, one in records:
        where = f"{path}: set {k}"
        if (function := int(one["func_type"])) not in TIME_FUNCTIONS:
            raise MeasurementError(
                f"{where}: a function of type {function} over time is no impulse response: "
                "expected a time response (1)"
            )
        per = int(one.get("orddenom_spec_data_type") or 0)
        if per != FORCE_TYPE and (per or not over_time):
            raise MeasurementError(
                f"{where}: a time response that is not per force: expected impulse responses, with "
                f"force ({FORCE_TYPE}) below, found the type {per}; if they are, give "
                'measured.quantity = "impulse", else frequency responses'
            )
        of = int(one.get("ordinate_spec_data_type") or 0)
        if of != ACCELERATION_TYPE and (of or not over_time):
            raise MeasurementError(
                f"{where}: expected an impulse response of acceleration ({ACCELERATION_TYPE}), "
                f"found the type {of}"
            )
        if np.iscomplexobj(one["data"]):
            raise MeasurementError(f"{where}: expected real numbers over time, found complex ones")
    times = np.asarray(records[0][1]["x"], dtype=float)
    response = _matrix(path, records, times, channels, hits).real
    response, step = from_the_hit(str(path), times, response)
    f, H = transformed(path, response, step)
    return UffResponses(f, H, "impulse", None)


def _matrix(
    path: Path, sets: list[NumberedSet], first: Array, channels: ChannelTable, hits: HitTable
) -> Complex:
    """The functions (k, n_o, n_i) of all channels by all hits, each once."""
    outputs = {name: k for k, name in enumerate(channels.names)}
    H = np.full((len(first), len(channels.names), len(hits.labels)), np.nan + 0j)
    for k, one in sets:
        where = f"{path}: set {k}"
        x, data = np.asarray(one["x"], dtype=float), np.asarray(one["data"], dtype=complex)
        if len(x) != len(first) or not _same_lines(x, first):
            raise MeasurementError(
                f"{where}: expected the {len(first)} lines of the first set, found {len(x)}"
            )
        o, sign = _channel(where, one, channels, outputs)
        label = str(int(one["ref_node"]))
        if label not in hits.labels:
            raise MeasurementError(f"{where}: no hit {label} in the table")
        i = hits.labels.index(label)
        sign *= _sign(int(one["ref_dir"]), hits.directions[i])
        if not np.isfinite(data).all():
            raise MeasurementError(
                f"{where}: expected finite numbers, found others in {channels.names[o]} by {label}"
            )
        if not np.isnan(H[0, o, i]):
            raise MeasurementError(
                f"{where}: expected each pair once, found {channels.names[o]} by {label} twice"
            )
        H[:, o, i] = sign * data
    if np.isnan(H[0]).any():
        o, i = np.argwhere(np.isnan(H[0]))[0]
        raise MeasurementError(
            f"{path}: expected all channels by all hits, found no set of {channels.names[o]} by "
            f"{hits.labels[i]}"
        )
    return H


def pyuff_module(path: Path, doing: str) -> Any:
    """pyuff, an extra; `MeasurementError` where it is not installed."""
    try:
        import pyuff
    except ImportError as error:
        raise MeasurementError(
            f"{path}: {doing} UFF takes pyuff: pip install 'duhamel[measured]'"
        ) from error
    return pyuff


def _same_lines(x: Array, first: Array) -> bool:
    """Whether two axes are one, also where they pass zero."""
    apart = float(np.ptp(first)) / len(first)
    return np.allclose(x, first, rtol=SAME_LINES, atol=SAME_LINES * apart)


def _is_over_time(one: Mapping[str, Any]) -> bool:
    """Whether a set is a record, whose abscissa is time."""
    return int(one.get("abscissa_spec_data_type") or 0) == TIME_TYPE


def _is_response(path: Path, k: int, one: Mapping[str, Any]) -> bool:
    """Whether a set is a frequency response; `MeasurementError` where it has no numbers."""
    # Nor does it say that the numbers of a set are broken off.
    if "data" not in one or "x" not in one or not np.size(one["data"]):
        raise MeasurementError(f"{path}: set {k}: expected numbers, found none that can be read")
    if int(one["func_type"]) != RESPONSE_FUNCTION:
        return False
    # Programs that leave types open write 0.
    for key, name, wanted in (
        ("abscissa_spec_data_type", "frequencies", FREQUENCY_TYPE),
        ("orddenom_spec_data_type", "responses per force", FORCE_TYPE),
    ):
        if (found := int(one.get(key) or 0)) not in (0, wanted):
            raise MeasurementError(
                f"{path}: set {k}: expected {name} ({wanted}), found the type {found}"
            )
    return True


def _channel(
    where: str, one: Mapping[str, Any], channels: ChannelTable, outputs: Mapping[str, int]
) -> tuple[int, float]:
    """The channel of a set, and the sign that makes it point as in the table."""
    label, code = str(int(one["rsp_node"])), int(one["rsp_dir"])
    if abs(code) not in (0, 1, 2, 3):
        raise MeasurementError(f"{where}: expected a direction from -3 to 3, found {code}")
    axis = "" if code == 0 else "xyz"[abs(code) - 1]
    for name in (f"{label}:{axis}", f"{label}:{abs(code)}", label):
        if name in outputs:
            o = outputs[name]
            # Numbered directions are those of a turned sensor, in its own axes.
            turned = name.endswith(f":{abs(code)}")
            return o, float(np.sign(code)) if turned else _sign(code, channels.directions[o])
    raise MeasurementError(f"{where}: no channel {label}:{axis} in the table")


def _sign(code: int, direction: Array) -> float:
    """1 or -1: whether a direction of the table is that of a code from -3 to 3, or against it."""
    if code == 0:
        return 1.0
    along = float(np.sign(code) * direction[abs(code) - 1])
    return -1.0 if along < 0.0 else 1.0
