"""The application: all commands, each a file of the folder `commands`."""

from typing import Annotated

import typer

from .commands import all_commands
from .failures import Commands

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


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


for command in all_commands():
    app.command()(command)
