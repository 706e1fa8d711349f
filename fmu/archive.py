"""The archive that an FMU is: the same bytes for the same contents."""

import io
import zipfile
from collections.abc import Mapping

TIME_OF_FILES = (1980, 1, 1, 0, 0, 0)


def archive(contents: Mapping[str, bytes]) -> bytes:
    """A zip archive of files by their paths in it."""
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w") as target:
        for name, content in contents.items():
            # The time of the export would make each file another one.
            info = zipfile.ZipInfo(name, TIME_OF_FILES)
            info.compress_type = zipfile.ZIP_DEFLATED
            # Without it, unpacked files have no permissions.
            info.external_attr = 0o644 << 16
            target.writestr(info, content)
    return memory.getvalue()
