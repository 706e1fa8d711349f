"""Errors and warnings of the packages as lines of text."""

import errno
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import typer
from typer.core import TyperGroup

from .call import call_of, note_error, note_warning

# Of what the context of a call keeps: all words behind the name of the program.
ARGUMENTS_KEY = "duhamel.arguments"
# Characters: names of files and models may be of any length.
MAX_LINE = 2000


class Commands(TyperGroup):
    """The commands; what the machine refuses them is told in one line, wherever it happens."""

    def make_context(self, *names: Any, **more: Any) -> Any:
        """Read the options, of which some print: what the machine refuses them is told as well."""
        try:
            return super().make_context(*names, **more)
        except OSError as error:
            _fail(_of_the_system(error), error)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        ctx.meta[ARGUMENTS_KEY] = list(args)
        rest: list[str] = super().parse_args(ctx, args)
        return rest

    def invoke(self, ctx: Any) -> Any:
        try:
            with call_of(ctx.meta[ARGUMENTS_KEY]):
                return self._invoke(ctx)
        except OSError as error:  # of the record itself
            _fail(_of_the_system(error), error)

    def _invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except MemoryError as error:
            _fail(f"out of memory: {error}" if str(error) else "out of memory", error)
        except RecursionError as error:
            _fail(f"nested too deep: {error}", error)
        except OSError as error:
            _fail(_of_the_system(error), error)
        except KeyboardInterrupt as interrupt:
            _stop(interrupt)


def _of_the_system(error: OSError) -> str:
    """What the system said; where nothing names a file, it was the output that is full.

    A reader that has gone, as `head`, is passed on: that is no error worth a line.
    """
    if error.errno == errno.EPIPE:
        raise error
    if error.filename is None and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        from ..files.outputs import in_words

        return f"standard output: cannot be written: {in_words(error)}"
    return str(error)


def one_line(text: object) -> str:
    """Text as one line, not at length; what cannot be printed is escaped, as in a path."""
    line = "".join(map(_printable, str(text)))
    return line if len(line) <= MAX_LINE else f"{line[:MAX_LINE]}..."


# After Ctrl-C, as shells have it.
INTERRUPTED_CODE = 130


@contextmanager
def errors_in_one_line(*packages: ModuleType, about: Path | None = None) -> Iterator[None]:
    """Print the exceptions and warnings that the packages export as one line each.

    `error: ...`, then exit with 1, or `warning: ...`. about: the file at fault, put before errors
    that do not name it. Any other exception is a defect of the program, and shows its traceback.
    """
    exported = _exported_exceptions(*packages)
    own_warnings = tuple(item for item in exported if issubclass(item, Warning))
    with warnings.catch_warnings():
        # Python shows a warning once for each place in the code, and users want it for each body.
        for category in own_warnings:
            warnings.simplefilter("always", category)
        show, told = warnings.showwarning, set[str]()

        def show_own(
            message: Warning | str, category: type[Warning], *where: Any, **more: Any
        ) -> None:
            if not issubclass(category, own_warnings):
                show(message, category, *where, **more)
            elif str(message) not in told:  # a Campbell diagram has one at each speed
                told.add(str(message))
                tell_warning(str(message))

        warnings.showwarning = show_own
        try:
            yield
        except exported as error:
            where = f"{about}: " if about else ""
            _fail(f"{where}{error}", error)
        except KeyboardInterrupt as interrupt:
            _stop(interrupt)


@contextmanager
def unwritten(target: Path, before: str = "") -> Iterator[None]:
    """Let an interrupt say that a file is not written, or is as it was.

    before: what had not begun, of an interrupt that does not tell itself what is left.
    """
    try:
        yield
    except KeyboardInterrupt as interrupt:
        if before and str(interrupt):
            raise
        told = str(interrupt) or f"interrupted {before}".rstrip()
        state = "stays as it was" if target.exists() else "is not written"
        raise KeyboardInterrupt(f"{told}; {target} {state}") from interrupt


def tell_warning(message: str) -> None:
    """A warning as one line, `warning: ...`, and in the record of the call."""
    note_warning(message)
    typer.echo(one_line(f"warning: {message}"), err=True)


def _stop(interrupt: KeyboardInterrupt) -> NoReturn:
    message = str(interrupt) or "interrupted"
    note_error(message)
    typer.echo(one_line(message), err=True)
    raise typer.Exit(INTERRUPTED_CODE) from interrupt


def tell_error(message: str) -> None:
    """An error as one line, `error: ...`, and in the record of the call."""
    note_error(message)
    typer.echo(one_line(f"error: {message}"), err=True)


def _fail(message: str, cause: BaseException) -> NoReturn:
    tell_error(message)
    raise typer.Exit(1) from cause


def _printable(character: str) -> str:
    if character.isprintable():
        return character
    return character.encode("unicode_escape", "surrogatepass").decode("ascii")


def _exported_exceptions(*packages: ModuleType) -> tuple[type[Exception], ...]:
    """The exception types, warnings among them, among the public names of packages."""
    # By their names, for to look at all that a package exports would load all of it.
    named = (
        getattr(package, name)
        for package in packages
        for name in package.__all__
        if name.endswith(("Error", "Warning"))
    )
    return tuple(item for item in named if isinstance(item, type) and issubclass(item, Exception))
