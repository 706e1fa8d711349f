"""The errors of the preprocessor: one exception for each kind of failure."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..files import FileError, in_one_line, require_regular


class PreprocessError(ValueError):
    """The base of all errors that keep a body from becoming a superelement."""


class BodyError(PreprocessError):
    """A body file that cannot be read, or that contradicts itself or its mesh."""


class MeshError(PreprocessError):
    """A mesh that cannot be read, or that makes no sound finite element model."""


class MatrixError(PreprocessError):
    """Matrices that are unreadable, do not fit their nodes, or are not of a free elastic body."""


class MeasurementError(PreprocessError):
    """A file of a modal test that cannot be read, or that does not fit its body."""


class InterfaceError(PreprocessError):
    """An interface or a mass that selects nothing, or too little to carry a frame."""


class MethodError(PreprocessError):
    """A method that cannot be used on this body."""


class MeshWarning(UserWarning):
    """A mesh file that holds more than is read of it."""


class PlausibilityWarning(UserWarning):
    """Something about a part that is unlike any that is built, most often a wrong unit."""


class MemoryShortageError(PreprocessError, MemoryError):
    """A build that needs more memory than is available; both in bytes."""

    def __init__(self, message: str, needed: float, available: float) -> None:
        super().__init__(message)
        self.needed = needed
        self.available = available


@contextmanager
def about(
    path: Path,
    failure: type[PreprocessError],
    missing: str,
    expected: str,
    damage: tuple[type[Exception], ...],
) -> Iterator[None]:
    """Errors within are of one kind and name the file, which must be a regular one.

    missing, expected: what is said of no file, and of one that raises a kind of damage.
    """
    try:
        require_regular(path)
        yield
    except FileNotFoundError as error:
        raise failure(f"{path}: no such {missing}") from error
    except (failure, FileError) as error:
        text = str(error)
        raise failure(text if text.startswith(f"{path}: ") else f"{path}: {text}") from error
    except PreprocessError:  # of another file, which it names
        raise
    except damage as error:
        raise failure(f"{path}: {expected}: {in_one_line(error)}") from error
