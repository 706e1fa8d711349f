"""Files of states: HDF5 with a dataset for each array, and a digest of all of it at the end.

They are written whole or not at all.
"""

import hashlib
import io
import uuid
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...files import renamed_when_whole, require_regular
from ...files.hdf5 import failures_named, require_kind
from ..errors import StateError
from .carried import Snapshot
from .identity import Identity

STATE_FORMAT = "duhamel-state"
STATE_VERSION = 2
STATE_SUFFIX = ".checkpoint"
# of a SHA-256
STATE_DIGEST_BYTES = 32
ARRAY_KINDS = ("f8", "i8")
"""types of arrays; complex ones are pairs of numbers"""


@dataclass(frozen=True, eq=False)
class StateFile:
    """A state with what it belongs to.

    run: the name of the run whose results it belongs to, "" if there is none; notes: numbers that
    go with it; without: the redundant rows that were left out.
    """

    snapshot: Snapshot
    identity: Identity
    run: str = ""
    without: tuple[int, ...] = ()
    notes: Mapping[str, float] = field(default_factory=dict)

    def write(self, path: Path) -> None:
        """Replace the file at a path durably; OSError leaves it as it was."""
        image = self._image()
        with renamed_when_whole(path, durable=True) as temporary:
            temporary.write_bytes(image)

    def _image(self) -> bytes:
        text = self.identity.to_text()
        # Made in memory: the digest is of the whole image, which then goes to the disk in one
        # piece.
        # HDF5 refuses a second file of the same name, such as that of a run in another thread.
        name = f"image-{uuid.uuid4().hex}"
        with h5py.File(name, "w", driver="core", backing_store=False) as file:
            file.attrs.update(
                format=STATE_FORMAT,
                version=STATE_VERSION,
                created_by=f"duhamel {metadata.version('duhamel')}",
                step=self.snapshot.step,
                run=self.run,
                without=np.array(self.without, dtype=np.int64),
                **self.notes,
            )
            file["identity"] = np.frombuffer(text.encode(), dtype=np.uint8)
            groups: dict[str, h5py.Group] = {}
            for name, array in self.snapshot.arrays.items():
                folder, _, last = f"arrays/{name}".rpartition("/")
                # Looked up once: for each array it takes as long as the array itself.
                if folder not in groups:
                    groups[folder] = file.require_group(folder)
                groups[folder].create_dataset(last, data=array)
            file.flush()
            image: bytes = file.id.get_file_image()
        return image + hashlib.sha256(image).digest()


def read_state(path: Path) -> StateFile:
    """The state in a file; `StateError` in one line for a file that is none, or damaged."""
    with failures_named(path, StateError, "state"), h5py.File(_whole(path), "r") as file:
        _check_format(file)
        text = _array("identity", file["identity"], "u1").tobytes().decode()
        arrays: dict[str, Any] = {}

        def keep(name: str, found: h5py.Group | h5py.Dataset) -> None:
            if isinstance(found, h5py.Dataset):
                arrays[name] = _array(f"arrays/{name}", found, *ARRAY_KINDS)

        # It does not follow links, which might lead out of the file.
        file["arrays"].visititems(keep)
        attributes = dict(file.attrs)
        return StateFile(
            Snapshot(int(attributes.pop("step")), arrays),
            Identity.from_text(text),
            str(attributes.pop("run")),
            tuple(attributes.pop("without").tolist()),
            {
                key: float(value)
                for key, value in attributes.items()
                if isinstance(value, np.floating)
            },
        )


def _whole(path: Path) -> io.BytesIO:
    """The HDF5 file in a file of a state; `StateError` unless its digest fits."""
    require_regular(path)
    content = path.read_bytes()
    # Checked before HDF5 sees the file, whose library may crash on damaged ones.
    image, digest = content[:-STATE_DIGEST_BYTES], content[-STATE_DIGEST_BYTES:]
    if hashlib.sha256(image).digest() != digest:
        raise StateError(
            "damaged, or not a state: the checksum at its end does not match its contents"
        )
    return io.BytesIO(image)


def _check_format(file: h5py.File) -> None:
    require_kind(file, STATE_FORMAT)
    if (version := int(file.attrs.get("version", 0))) != STATE_VERSION:
        raise StateError(f"state of version {version}; this Duhamel reads version {STATE_VERSION}")


def _array(name: str, dataset: h5py.Dataset, *kinds: str) -> Any:
    """An array that lies in the file as a whole, so that it is no larger than the file."""
    # A small file may declare terabytes, compressed or not stored at all.
    stored = dataset.id.get_storage_size() == dataset.nbytes and dataset.chunks is None
    if not stored or dataset.external or dataset.is_virtual or dataset.dtype not in kinds:
        raise StateError(f"{name}: expected numbers in one piece, found {dataset}")
    return dataset[()]
