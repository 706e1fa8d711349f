"""Outputs that must not replace inputs."""

import os
from collections.abc import Iterable, Mapping

AnyPath = str | os.PathLike[str]


def clash(targets: Iterable[AnyPath], inputs: Mapping[AnyPath, str]) -> str:
    """Says which target is an input, as "TARGET is ROLE"; "" if none is.

    inputs: roles by path, as "the model file". The same file by another name, or through a link,
    is found too.
    """
    roles = {_identity(path): role for path, role in inputs.items()}
    for target in targets:
        identity = _identity(target)
        if identity is not None and (role := roles.get(identity)):
            return f"{os.fspath(target)} is {role}"
    return ""


def _identity(path: AnyPath) -> tuple[int, int] | None:
    """Device and number of a file; None where there is none."""
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return None
    return status.st_dev, status.st_ino
