"""One call of the program: its record in JSON for other programs, and its failure, which is kept.

With --json the standard output has one record and nothing else: what a command prints for people
goes to the standard error. docs/command-line.md describes the records.
"""

import json
import sys
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from datetime import UTC, datetime
from math import isfinite
from typing import Annotated, Any

import typer

RECORD_VERSION = 1
JSON_OPTION = "--json"
LAST_FAILURE_FILE = "last-failure.json"
REPORT_COMMAND = "bug-report"
# Typer brings its own copy of click, or takes that of click: by its name either is found.
ClickException: Any = typer.BadParameter.__mro__[2]

AsJson = Annotated[
    bool,
    typer.Option(JSON_OPTION, help="Print one record in JSON; all else goes to standard error."),
]


@dataclass
class Call:
    """What is known of a call while it runs."""

    arguments: Sequence[str]
    content: Mapping[str, Any] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    error: str = ""

    @property
    def command(self) -> str:
        return next((word for word in self.arguments if not word.startswith("-")), "")

    @property
    def wants_json(self) -> bool:
        return JSON_OPTION in self.arguments

    def record(self, exit_code: int) -> dict[str, Any]:
        """All that a program is told of the call."""
        known = {
            "schema_version": RECORD_VERSION,
            "duhamel_version": _version(),
            "command": self.command,
            "exit_code": exit_code,
            "warnings": self.warnings,
        }
        if self.error:
            known["error"] = self.error
        return known | dict(self.content)


_current: ContextVar[Call | None] = ContextVar("call", default=None)


def give_record(content: Mapping[str, Any]) -> None:
    """Give the record of this call its content."""
    if (call := _current.get()) is not None:
        call.content = content


def note_warning(message: str) -> None:
    if (call := _current.get()) is not None:
        call.warnings.append(message)


def note_error(message: str) -> None:
    if (call := _current.get()) is not None:
        call.error = f"{call.error}; {message}" if call.error else message


@contextmanager
def call_of(arguments: Sequence[str]) -> Iterator[None]:
    """Print the record of a call that wants JSON when it ends, and keep the failure of any."""
    call, output = Call(arguments), sys.stdout
    token = _current.set(call)
    exit_code = 0
    try:
        with redirect_stdout(sys.stderr if call.wants_json else output):
            yield
    except typer.Exit as end:
        exit_code = end.exit_code
        if exit_code == 1:
            _keep_failure(call)
        raise
    except ClickException as error:
        exit_code, call.error = error.exit_code, error.format_message()
        raise
    except BrokenPipeError:  # the reader has gone, as `head`: no failure of the command
        raise
    except Exception as error:
        exit_code, call.error = 1, f"{type(error).__name__}: {error}"
        _keep_failure(call, traceback.format_exc())
        raise
    finally:
        _current.reset(token)
        if call.wants_json:
            record = json.dumps(plain(call.record(exit_code)), indent=2, allow_nan=False)
            print(record, file=output, flush=True)


def _version() -> str:
    from importlib.metadata import version

    return version("duhamel")


def plain(value: Any) -> Any:
    """A value as JSON has it: arrays are lists, and what is no finite number is null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def last_failure() -> dict[str, Any] | None:
    """The failure that was kept last, None where there is none."""
    from ..solver.compiler.cache import opened_cache

    with suppress(OSError, ValueError), opened_cache() as folder:
        kept: dict[str, Any] = json.loads(folder.read(LAST_FAILURE_FILE))
        return kept
    return None


def _keep_failure(call: Call, trace: str = "") -> None:
    """Keep a failure beside the compiled code, where only this user reads and writes."""
    from ..solver.compiler.cache import opened_cache

    # A report that fails must not replace the failure that it is of.
    if call.command == REPORT_COMMAND or not call.error:
        return
    kept = {
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "duhamel": _version(),
        "arguments": list(call.arguments),
        "error": call.error,
        "traceback": trace,
    }
    # A disk that is full is no second failure.
    with suppress(OSError), opened_cache(make=True) as folder:
        folder.write(LAST_FAILURE_FILE, json.dumps(kept, indent=2).encode())
