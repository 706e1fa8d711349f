"""Modes that a test has found: frequencies, damping and shapes at its channels."""

import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...files.arrays import Array, Complex
from ..errors import MeasurementError, about
from .channels import ChannelTable, read_rows

LARGEST_DAMPING = 0.3
"""of critical, beyond which a ratio is rather one in per cent"""
DOUBTED_COMPLEXITY, LARGEST_COMPLEXITY = 0.1, 0.3
"""parts of a shape out of phase that are warned of, and that are refused"""

DAMAGE_OF_ARRAYS = (OSError, TypeError, ValueError, EOFError, zipfile.BadZipFile)
"""what reading arrays raises"""


@dataclass(frozen=True, eq=False)
class ModalData:
    """Measured modes in the order of their frequencies.

    frequency (m,) [Hz], damping (m,) of critical, shapes (m, n) at the channels of a table, of any
    scale, turned to be as real as they can; complexity (m,): the part that stays out of phase.
    """

    frequency: Array
    damping: Array
    shapes: Array
    complexity: Array


def read_modes(path: Path, channels: ChannelTable) -> ModalData:
    """The modes of a table (.csv) or of arrays (.npz).

    A table has the columns frequency [Hz], damping, and one for each channel by its name, real or
    as 0.1+0.02j. Arrays are `frequency` (m,), `damping` (m,) and `shapes` (m, n), with `channels`
    (n,) of names unless they are in the order of the table of channels.

    `MeasurementError` names the file, what was found and what was expected.
    """
    read = _of_arrays if path.suffix.lower() == ".npz" else _of_table
    frequency, damping, shapes = read(path, channels)
    m, n = len(frequency), len(channels.names)
    if damping.shape != (m,) or shapes.shape != (m, n) or not m:
        raise MeasurementError(
            f"{path}: expected {n} channels and a damping for each of {m} frequencies, found "
            f"shapes {shapes.shape} and damping {damping.shape}"
        )
    if not all(np.isfinite(values).all() for values in (frequency, damping, shapes)):
        raise MeasurementError(f"{path}: expected finite numbers, found others")
    if not (frequency > 0.0).all():
        raise MeasurementError(f"{path}: frequency: expected Hz above 0, found {frequency.min():g}")
    if not ((damping > 0.0) & (damping <= LARGEST_DAMPING)).all():
        wrong = damping[~((damping > 0.0) & (damping <= LARGEST_DAMPING))][0]
        raise MeasurementError(
            f"{path}: damping: expected ratios above 0 and up to {LARGEST_DAMPING:g} of critical, "
            f"found {wrong:g}: is it in per cent?"
        )
    # Programs write modes in the order in which their user picked them.
    order = np.argsort(frequency, kind="stable")
    turned, complexity = zip(*map(_turned, shapes[order]), strict=True)
    if max(complexity) > LARGEST_COMPLEXITY:
        worst = int(np.argmax(complexity))
        raise MeasurementError(
            f"{path}: the mode at {frequency[order][worst]:.5g} Hz is complex: "
            f"{100.0 * complexity[worst]:.0f} % of its shape is out of phase, expected at most "
            f"{100.0 * LARGEST_COMPLEXITY:.0f} %"
        )
    return ModalData(frequency[order], damping[order], np.array(turned), np.array(complexity))


def _turned(shape: Complex) -> tuple[Array, float]:
    """A shape, turned to be as real as it can, and the part of it that is not."""
    total = np.linalg.norm(shape)
    # A shape that no channel sees has no phase.
    if total == 0.0:
        return shape.real, 0.0
    # The phase that makes the sum of the squares real makes its real part largest.
    turned = shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))
    return turned.real, float(np.linalg.norm(turned.imag) / total)


def _of_table(path: Path, channels: ChannelTable) -> tuple[Array, Array, Complex]:
    columns, rows = read_rows(path)
    _require_channels(path, columns, ["frequency", "damping", *channels.names])
    values = np.empty((len(rows), len(channels.names) + 2), dtype=complex)
    for i, row in enumerate(rows):
        for k, name in enumerate(["frequency", "damping", *channels.names]):
            try:
                # Python reads no blanks in complex numbers, and other programs write i for j.
                values[i, k] = complex((row[name] or "").replace(" ", "").replace("i", "j"))
            except ValueError:
                raise MeasurementError(
                    f"{path}: line {i + 2}: {name}: expected a number, found {row[name]!r}"
                ) from None
    return values[:, 0].real, values[:, 1].real, values[:, 2:]


def _of_arrays(path: Path, channels: ChannelTable) -> tuple[Array, Array, Complex]:
    with (
        about(path, MeasurementError, "file", "not readable arrays", DAMAGE_OF_ARRAYS),
        np.load(path) as file,
    ):
        arrays: dict[str, Any] = {key: file[key] for key in file.files}
        for key in ("frequency", "damping"):
            if key in arrays:
                arrays[key] = np.asarray(arrays[key], dtype=float).ravel()
        if "shapes" in arrays:
            arrays["shapes"] = np.atleast_2d(np.asarray(arrays["shapes"], dtype=complex))
    if missing := [key for key in ("frequency", "damping", "shapes") if key not in arrays]:
        raise MeasurementError(
            f"{path}: expected the arrays frequency, damping and shapes, found no "
            f"{' and no '.join(missing)}"
        )
    shapes = arrays["shapes"]
    if "channels" in arrays:
        names = [str(name) for name in arrays["channels"]]
        _require_channels(path, names, list(channels.names))
        if shapes.shape[1] != len(names):
            raise MeasurementError(
                f"{path}: shapes: expected {len(names)} columns, as many as channels, found "
                f"{shapes.shape[1]}"
            )
        # In the order of the table of channels, from which directions are taken.
        shapes = shapes[:, [names.index(name) for name in channels.names]]
    return arrays["frequency"], arrays["damping"], shapes


def _require_channels(path: Path, found: list[str], expected: list[str]) -> None:
    """That all are there, and no others: a name with a slip would be left out without a word."""
    missing = [name for name in expected if name not in found]
    unknown = [name for name in found if name not in expected]
    if missing or unknown:
        parts = [f"no {', '.join(missing)}"] if missing else []
        parts += (
            [f"{', '.join(unknown)}, which the table of channels does not have"] if unknown else []
        )
        raise MeasurementError(
            f"{path}: expected a column for each channel, found {' and '.join(parts)}"
        )
