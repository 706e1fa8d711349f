"""The numbers of an XDMF file, wherever it keeps them."""

from math import prod
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ....files import require_regular
from ....files.hdf5 import opened, whole
from ...errors import MeshError
from ..mesh import IntArray

_TYPES = {"int": "i", "uint": "u", "char": "i", "uchar": "u", "float": "f"}
_ORDERS = {"little": "<", "big": ">", "native": "="}


class DataItems:
    """Finds the numbers of an element in its DataItem; paths are relative to the file."""

    def __init__(self, path: Path, root: ElementTree.Element) -> None:
        self._folder = path.parent
        self._root = root

    def integers(self, owner: ElementTree.Element) -> IntArray:
        values = self.values(owner)
        if values.dtype.kind not in "iu":
            raise MeshError(f"{owner.tag}: expected integers, found numbers of type {values.dtype}")
        return np.asarray(values.astype(np.int64, copy=False))

    def values(self, owner: ElementTree.Element) -> Any:
        """The array of an element in its dimensions; `MeshError` if it is not there as a whole."""
        items = owner.findall("DataItem")
        if len(items) != 1:
            raise MeshError(f"{owner.tag}: expected one DataItem, found {len(items)}")
        item = self._referenced(items[0])
        if item.get("ItemType", "Uniform") != "Uniform":
            raise MeshError(f"{owner.tag}: unsupported DataItem of type {item.get('ItemType')}")
        try:
            shape = [int(size) for size in item.get("Dimensions", "").split()]
            values = self._stored(item, (item.text or "").strip())
        except (OSError, KeyError, ValueError, OverflowError, RuntimeError) as error:
            raise MeshError(
                f"{owner.tag}: the numbers of its DataItem cannot be read: {error}"
            ) from error
        # HDF5 files of an interrupted run are short without being damaged.
        if not shape or values.size != prod(shape):
            raise MeshError(f"{owner.tag}: expected {shape} numbers, found {values.size}")
        return values.reshape(shape)

    def files(self) -> list[Path]:
        """The files that hold numbers, as far as they are there."""
        found = []
        for item in self._root.iter("DataItem"):
            form, text = item.get("Format", "XML").upper(), (item.text or "").strip()
            if form != "XML" and text:
                found.append(self._folder / (text.rpartition(":")[0] if form == "HDF" else text))
        return found

    def _referenced(self, item: ElementTree.Element) -> ElementTree.Element:
        """The item, or that which it refers to by a path from /Xdmf on."""
        reference = item.get("Reference")
        if reference is None:
            return item
        path = (item.text or "") if reference == "XML" else reference
        try:
            target = self._root.find("./" + path.strip().removeprefix("/Xdmf/"))
        except SyntaxError as error:
            raise MeshError(
                f"DataItem: the reference {path.strip()!r} is no path: {error}"
            ) from error
        if target is None or target.get("Reference") is not None:
            raise MeshError(f"DataItem: nothing at the reference {path.strip()!r}")
        return target

    def _stored(self, item: ElementTree.Element, text: str) -> Any:
        kind = (item.get("NumberType") or item.get("DataType") or "Float").lower()
        size = 1 if kind in ("char", "uchar") else int(item.get("Precision", "4"))
        order = _ORDERS[item.get("Endian", "Native").lower()]
        if kind not in _TYPES or size not in (1, 2, 4, 8):
            raise ValueError(f"numbers of type {kind} and precision {size}")
        dtype = np.dtype(f"{order}{_TYPES[kind]}{size}")
        match item.get("Format", "XML").upper():
            case "XML":
                return np.array(text.split(), dtype=dtype)
            case "BINARY":
                require_regular(self._folder / text)
                return np.fromfile(
                    self._folder / text, dtype=dtype, offset=int(item.get("Seek", "0"))
                )
            case "HDF":
                name, _, dataset = text.rpartition(":")
                with opened(self._folder / name, MeshError) as file:
                    return whole(file[dataset])
            case other:
                raise ValueError(f"the format {other!r} is not known")
