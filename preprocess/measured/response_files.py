"""Frequency responses written to files: arrays of NumPy, or UFF58 in binary form by pyuff.

Source: Universal File Datasets Summary, University of Cincinnati, dataset 58.
"""

import warnings
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ...files import renamed_when_whole
from ...files.arrays import Array
from ..errors import MeasurementError
from .channels import ChannelTable
from .frequency_data import FrequencyData
from .hits import HitTable
from .uff import FORCE_TYPE, FREQUENCY_TYPE, QUANTITY_OF_TYPE, RESPONSE_FUNCTION, pyuff_module

ACCELERANCE_TYPE = next(k for k, name in QUANTITY_OF_TYPE.items() if name == "accelerance")
LARGEST_UFF_LABEL = 9_999_999_999
"""ten digits, as wide as its field is"""
ALONG_AXIS = 1.0 - 1e-9
"""cosine of a direction that is that of an axis"""


def write_responses(
    path: Path, data: FrequencyData, channels: ChannelTable, hits: HitTable
) -> None:
    """Write accelerances of all channels by all hits, to a file .npz, .uff or .unv.

    It appears whole or not at all. `MeasurementError` names the file, and a label that UFF cannot
    have.
    """
    suffix = require_writable_format(path)
    # In the order of the tables, so that no names are needed.
    if suffix == ".npz":
        with (
            renamed_when_whole(path, failure=MeasurementError) as temporary,
            temporary.open("wb") as file,
        ):
            np.savez(file, f=data.f, H=data.H, quantity="accelerance")
        return
    pyuff = pyuff_module(path, "writing")
    with (
        renamed_when_whole(path, failure=MeasurementError) as temporary,
        temporary.open("wb") as file,
        TemporaryDirectory() as folder,
        warnings.catch_warnings(),
    ):
        # pyuff leaves files to be closed with their last reference.
        warnings.simplefilter("ignore", ResourceWarning)
        for one in _sets(path, data, channels, hits):
            # Of a file of several sets pyuff reads all again for each one that it adds; and in its
            # mode "overwrite" it cuts off the head of a first set that is binary.
            alone = Path(folder) / "set.uff"
            pyuff.UFF(str(alone)).write_sets([one], mode="add")
            file.write(alone.read_bytes())
            alone.unlink()


def require_writable_format(path: Path) -> str:
    """The suffix of a file that can be written; `MeasurementError` of another one."""
    suffix = path.suffix.lower()
    if suffix not in (".npz", ".uff", ".unv"):
        raise MeasurementError(
            f"{path}: expected a file .npz, .uff or .unv, found {suffix or 'no suffix'}"
        )
    return suffix


def _sets(path: Path, data: FrequencyData, channels: ChannelTable, hits: HitTable) -> Any:
    for i, hit in enumerate(hits.labels):
        for o, label in enumerate(channels.labels):
            yield {
                "type": 58,
                "binary": 1,
                "func_type": RESPONSE_FUNCTION,
                "id1": f"{channels.names[o]} by {hit}"[:80],
                "rsp_node": _node(path, "sensor", label),
                "rsp_dir": _code_of_channel(channels, o),
                "ref_node": _node(path, "hit", hit),
                "ref_dir": _code(hits.directions[i]),
                "abscissa_spec_data_type": FREQUENCY_TYPE,
                "ordinate_spec_data_type": ACCELERANCE_TYPE,
                "orddenom_spec_data_type": FORCE_TYPE,
                "x": data.f,
                "data": data.H[:, o, i],
            }


def _node(path: Path, kind: str, label: str) -> int:
    if not (label.isascii() and label.isdigit()) or int(label) > LARGEST_UFF_LABEL:
        raise MeasurementError(
            f"{path}: {kind} {label}: UFF files have numbers as labels: expected one in the table, "
            "or a file .npz"
        )
    return int(label)


def _code_of_channel(channels: ChannelTable, o: int) -> int:
    """The direction of a channel: along an axis, or by its number at the sensor."""
    number = channels.names[o].rpartition(":")[2]
    has_several = ":" in channels.names[o]
    return int(number) if has_several and number.isdigit() else _code(channels.directions[o])


def _code(direction: Array) -> int:
    """1 to 3 along x, y, z, with the sign of the direction; 0 of another one."""
    axis = int(np.abs(direction).argmax())
    along = float(direction[axis])
    return int(np.sign(along)) * (axis + 1) if abs(along) > ALONG_AXIS else 0
