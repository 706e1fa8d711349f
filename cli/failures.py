"""Which failures are the user's to mend, and how they are told."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

import typer


@contextmanager
def told_in_one_line(*packages: ModuleType) -> Iterator[None]:
    """Print `error: ...` and exit with 1 on an exception that the packages export.

    Any other exception is a defect of the program, and shows its traceback.
    """
    try:
        yield
    except exported_exceptions(*packages) as error:
        typer.echo(f"error: {error}", err=True)
        raise typer.Exit(1) from error


def exported_exceptions(*packages: ModuleType) -> tuple[type[Exception], ...]:
    """The exception types among the public names of packages."""
    names = (getattr(package, name) for package in packages for name in package.__all__)
    return tuple(item for item in names if isinstance(item, type) and issubclass(item, Exception))
