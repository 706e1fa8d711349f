"""Damage to the contents of HDF5 files, where flipped bytes are mostly found by checksums."""

import io
import random
from contextlib import suppress
from typing import Any

import h5py
import numpy as np

STRANGE: tuple[Any, ...] = (
    np.nan,
    np.inf,
    -1.0,
    0.0,
    1e308,
    5e-324,
    2**62,
    -1,
    True,
    "text",
    b"\xff\xfe",
    "a\nb" * 100,
    [],
    [[1.0, 2.0]],
    1j,
    np.zeros((0, 3)),
    np.zeros((2, 3, 4, 5)),
    h5py.Empty("f8"),
)


def mutated(number: int, seed: bytes) -> bytes:
    """A seed with one to three objects or attributes replaced, lost, renamed or reshaped."""
    rng = random.Random(number)
    image = io.BytesIO(seed)
    with h5py.File(image, "r+") as file:
        for _ in range(rng.choice((1, 1, 2, 3))):
            # HDF5 refuses some of the damage itself.
            with suppress(OSError, TypeError, ValueError, RuntimeError, MemoryError):
                _mutate(rng, file)
    return image.getvalue()


def _mutate(rng: random.Random, file: h5py.File) -> None:
    names: list[str] = [""]
    file.visit(names.append)
    name = rng.choice(names)
    item = file[name] if name else file
    if len(item.attrs) and rng.random() < 0.4:
        _mutate_attribute(rng, item)
    elif isinstance(item, h5py.Dataset) and rng.random() < 0.6:
        _mutate_values(rng, item)
    elif name:
        _replace(rng, file, name)


def _mutate_attribute(rng: random.Random, item: Any) -> None:
    key = rng.choice(list(item.attrs))
    if rng.random() < 0.3:
        del item.attrs[key]
    else:
        item.attrs[key] = rng.choice(STRANGE)


def _mutate_values(rng: random.Random, dataset: h5py.Dataset) -> None:
    """Some of the numbers: others, or all times a factor, or in another order."""
    if dataset.dtype.kind not in "fi" or not dataset.size or dataset.dtype.itemsize < 4:
        return
    values = dataset[()]
    flat = np.atleast_1d(values).reshape(-1)
    if rng.random() < 0.5:
        strange = (
            (np.nan, np.inf, -1.0, 0.0, 1e308, 1e-308, 1e12)
            if flat.dtype.kind == "f"
            else (-1, 0, 2**31 - 1)
        )
        flat[rng.randrange(len(flat))] = rng.choice(strange)
    elif rng.random() < 0.5:
        flat *= flat.dtype.type(rng.choice((-1, 0, 2)))
    else:
        flat[:] = flat[::-1].copy()
    dataset[()] = flat.reshape(np.shape(values))


def _replace(rng: random.Random, file: h5py.File, name: str) -> None:
    """Another object at a name, or none."""
    other = rng.choice(STRANGE)
    del file[name]
    choice = rng.randrange(6)
    if choice == 0:
        file.create_group(name)
    elif choice == 1:
        file.create_dataset(name, data=other)
    elif choice == 2:
        file.create_dataset(
            name, shape=(10**9, 3), dtype="f8", chunks=(1024, 3), maxshape=(None, 3)
        )
    elif choice == 3:
        file[name] = rng.choice((h5py.SoftLink("/"), h5py.ExternalLink("/etc/passwd", "/")))
    elif choice == 4:
        file.create_dataset(
            name, data=np.array(["x", "y\nz"], dtype=object), dtype=h5py.string_dtype()
        )
