"""The application: all commands, each a file of the folder `commands`."""

import gc
import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from typer.main import get_command

from .commands import command_names, command_of
from .failures import Commands

# Objects that are made before Python looks for those that only hold one another.
GARBAGE_THRESHOLD = 50_000


@contextmanager
def _fewer_collections() -> Iterator[None]:
    """Packages that are imported are objects that live to the end: to look through them again and
    again takes a twentieth of a start.
    """
    threshold = gc.get_threshold()
    gc.set_threshold(GARBAGE_THRESHOLD, *threshold[1:])
    try:
        yield
    finally:
        gc.set_threshold(*threshold)


class _LazyCommands(Commands):
    """The commands, of which a call imports that which it needs: so `duhamel run` starts fast."""

    def main(self, *args: Any, **options: Any) -> Any:
        # A code page of Windows lacks letters that names have: they are escaped, as in errors.
        if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.encoding.lower() != "utf-8":
            sys.stdout.reconfigure(errors="backslashreplace")
        with _fewer_collections():
            return super().main(*args, **options)

    def list_commands(self, ctx: Any) -> list[str]:
        return command_names()

    def get_command(self, ctx: Any, name: str) -> Any:
        names = command_names()
        # For a name that there is not, Typer looks for the one that was meant among all.
        for each in [name] if name in names else names:
            if each not in self.commands:
                alone = typer.Typer(add_completion=False)
                alone.command(each)(command_of(each))
                self.commands[each] = get_command(alone)
        return super().get_command(ctx, name)


app = typer.Typer(cls=_LazyCommands, no_args_is_help=True, pretty_exceptions_enable=False)


def _tell_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"duhamel {version('duhamel')}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option(
        "--version", callback=_tell_version, is_eager=True, help="Print the version and exit."
    ),
]


@app.callback()
def duhamel(version: Version = False) -> None:
    """Impulse superelements from meshes, and multibody dynamics on them."""
