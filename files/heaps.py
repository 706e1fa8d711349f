"""The heaps in which HDF5 keeps texts, looked at before HDF5 does: damage there never ends for it.

A heap is a chain of objects, each with its size; one of size 0 leads HDF5 back to itself. Source:
HDF5 File Format Specification, III.E, Global Heap.
"""

import mmap
import os
import struct

from .regular import FileError

HEAP_SIGNATURE = b"GCOL\1\0\0\0"
# Of a heap, and of each object in it.
HEAP_HEADER_BYTES = 16
# 256 MiB take a tenth of a second.
MAX_SCANNED_BYTES = 1 << 28


def require_ending_heaps(path: str | os.PathLike[str]) -> None:
    """`FileError` for a heap whose chain of objects does not end."""
    with open(path, "rb") as file:
        if not (size := min(os.fstat(file.fileno()).st_size, MAX_SCANNED_BYTES)):
            return
        with mmap.mmap(file.fileno(), size, access=mmap.ACCESS_READ) as data:
            at = data.find(HEAP_SIGNATURE)
            while at >= 0:
                _follow(data, at)
                at = data.find(HEAP_SIGNATURE, at + len(HEAP_SIGNATURE))


def _follow(data: mmap.mmap, at: int) -> None:
    (size,) = struct.unpack_from("<Q", data[at + 8 : at + HEAP_HEADER_BYTES].ljust(8, b"\0"))
    position, end = at + HEAP_HEADER_BYTES, min(at + size, len(data))
    while position + HEAP_HEADER_BYTES <= end:
        index, length = struct.unpack_from("<H6xQ", data, position)
        if index == length == 0:
            raise FileError(f"the heap of texts at byte {at} does not end")
        # what is free counts with its header, what is not without, and in whole words
        position += (
            HEAP_HEADER_BYTES + -(-length // 8) * 8 if index else max(length, HEAP_HEADER_BYTES)
        )
