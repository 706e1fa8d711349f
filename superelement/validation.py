"""Checks of the arrays of a superelement; each failure quotes the value found."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..files.arrays import Array as Array
from ..files.arrays import IntArray

# Relative to the scale of the diagonal; iterative solvers leave more than rounding.
SYMMETRY_TOLERANCE = 1e-8


# No quantity of a body is larger, and the square of this is still a finite number. Masses,
# inertias, steps and frequencies are at least its inverse.
MAX_MAGNITUDE = 1e100


class SuperelementError(ValueError):
    """A superelement, or its file, with missing, contradictory or invalid entries."""


def checked(name: str, value: Any, shape: Sequence[int | str]) -> Array:
    """A read-only contiguous float array of a shape, in which a letter allows any length."""
    try:
        found = np.asarray(value)
        real = found.real if np.iscomplexobj(found) else found
        # What is read-only, as the arrays of a superelement are, can be shared.
        array = real.astype(np.float64, order="C", copy=bool(found.flags.writeable))
    except (TypeError, ValueError) as error:
        raise SuperelementError(
            f"{name}: expected numbers of shape {_text(shape)}, found others: {error}"
        ) from error
    if np.iscomplexobj(found):
        raise SuperelementError(
            f"{name}: expected real numbers of shape {_text(shape)}, found complex ones"
        )
    check_shape(name, array.shape, shape)
    if not _within_bounds(array):
        _require_bounds(name, array)
    array.flags.writeable = False
    return array


def checked_integers(name: str, value: Any, shape: Sequence[int | None]) -> IntArray:
    """Read-only integers of a shape, in which None allows any length."""
    found = np.array(value, order="C")
    fits = len(found.shape) == len(shape) and all(
        want in (None, have) for want, have in zip(shape, found.shape, strict=True)
    )
    if not fits or not np.issubdtype(found.dtype, np.integer):
        wanted = ", ".join("n" if want is None else str(want) for want in shape)
        raise SuperelementError(
            f"{name}: expected integers of shape ({wanted}), found {found.dtype} {found.shape}"
        )
    found = found.astype(np.int64)
    found.flags.writeable = False
    return found


def _within_bounds(array: Array) -> bool:
    """Whether all magnitudes are numbers up to `MAX_MAGNITUDE`; no array is made for it."""
    return bool(
        array.min(initial=0.0) >= -MAX_MAGNITUDE and array.max(initial=0.0) <= MAX_MAGNITUDE
    )


def _require_bounds(name: str, array: Array) -> None:
    """`SuperelementError` that says what is not finite or too large."""
    if not np.isfinite(array).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        position = f" at index {where}" if where else ""
        raise SuperelementError(f"{name}: expected finite numbers, found {array[where]}{position}")
    if (too_large := np.abs(array) > MAX_MAGNITUDE).any():
        raise SuperelementError(
            f"{name}: expected magnitudes up to {MAX_MAGNITUDE:g}, found {array[too_large][0]}"
        )


def check_shape(name: str, found: Sequence[int], shape: Sequence[int | str]) -> None:
    """SuperelementError unless a shape is as asked for; a letter allows any length."""
    fits = len(found) == len(shape) and all(
        isinstance(want, str) or want == have for want, have in zip(shape, found, strict=True)
    )
    if not fits:
        raise SuperelementError(f"{name}: expected shape {_text(shape)}, found {_text(found)}")


def check_positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise SuperelementError(f"{name}: expected a positive number, found {value}")
    if not 1.0 / MAX_MAGNITUDE <= value <= MAX_MAGNITUDE:
        raise SuperelementError(
            f"{name}: expected a number from {1.0 / MAX_MAGNITUDE:g} to {MAX_MAGNITUDE:g}, found "
            f"{value}"
        )


def check_name(kind: str, name: str) -> None:
    """`SuperelementError` for a name that is not one line without '/' and '.'."""
    if not (name and name.isprintable()) or "/" in name or "." in name:
        raise SuperelementError(
            f"{kind} name: expected one line without '/' and '.', found {name!r}"
        )


def check_symmetric(name: str, matrices: Array) -> None:
    """SuperelementError unless `matrices` (..., n, n) are symmetric, relative to their diagonals.

    Rows of a kernel mix meters and radians, so each entry is measured against
    sqrt(max |a_ii| max |a_jj|), the scale that its own two rows give it.
    """
    if matrices.size == 0:
        return
    n = matrices.shape[-1]
    stack = matrices.reshape(-1, n, n)
    scale = np.sqrt(np.abs(np.diagonal(stack, axis1=1, axis2=2)).max(axis=0))
    defect = np.abs(stack - stack.transpose(0, 2, 1)).max(axis=0)
    allowed = SYMMETRY_TOLERANCE * np.outer(scale, scale)
    if (defect > allowed).any():
        i, j = np.unravel_index(int(np.argmax(defect - allowed)), defect.shape)
        raise SuperelementError(
            f"{name}: expected a symmetric matrix, found entries ({i}, {j}) and ({j}, {i}) that "
            f"differ by {defect[i, j]:.3e}, where the diagonal allows {allowed[i, j]:.3e}"
        )


def _text(shape: Sequence[int | str]) -> str:
    return "(" + ", ".join(str(n) for n in shape) + ("," if len(shape) == 1 else "") + ")"
