"""Errors and warnings of the packages as lines of text."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import typer

INTERRUPTED = 130
"""exit code after Ctrl-C, as shells have it"""


@contextmanager
def errors_in_one_line(*packages: ModuleType, about: Path | None = None) -> Iterator[None]:
    """Print the exceptions and warnings that the packages export as one line each.

    `error: ...`, then exit with 1, or `warning: ...`. about: the file at fault, put before errors
    that do not name it. Any other exception is a defect of the program, and shows its traceback.
    """
    exported = _exported_exceptions(*packages)
    own_warnings = tuple(item for item in exported if issubclass(item, Warning))
    with warnings.catch_warnings():
        for category in own_warnings:
            warnings.simplefilter("always", category)
        show = warnings.showwarning

        def show_own(
            message: Warning | str, category: type[Warning], *where: Any, **more: Any
        ) -> None:
            if issubclass(category, own_warnings):
                typer.echo(f"warning: {message}", err=True)
            else:
                show(message, category, *where, **more)

        warnings.showwarning = show_own
        try:
            yield
        except exported as error:
            where = f"{about}: " if about else ""
            typer.echo(f"error: {where}{error}", err=True)
            raise typer.Exit(1) from error
        except KeyboardInterrupt as interrupt:
            typer.echo(str(interrupt) or "interrupted", err=True)
            raise typer.Exit(INTERRUPTED) from interrupt


def _exported_exceptions(*packages: ModuleType) -> tuple[type[Exception], ...]:
    """The exception types, warnings among them, among the public names of packages."""
    names = (getattr(package, name) for package in packages for name in package.__all__)
    return tuple(item for item in names if isinstance(item, type) and issubclass(item, Exception))
