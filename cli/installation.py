"""The text of `duhamel bug-report`: this installation and its last failure, without names."""

import getpass
import hashlib
import os
import platform
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import tomli_w

from ..files.cores import usable_cores
from ..files.memory import available
from ..inputs import InputError, read_toml
from .call import last_failure

REPORT_VERSION = 1
REPORTED_VARIABLES = (
    "DUHAMEL_COMPILER",
    "NUMBA_DISABLE_JIT",
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
)
USER_FOLDER_SIGN = "<user folder>"
DISTRIBUTION_NAME = re.compile(r"[\w.-]+")
# Names of folders with what separates them; a quotation mark between letters belongs to a name.
FOLDER_PARTS = r"(?:(?:[^\\/:'\"\n]|(?<=\w)['\"](?=\w))+[\\/])"
# An absolute path up to its last name; behind a letter or a bracket a slash begins none.
ABSOLUTE_FOLDERS = re.compile(rf"(?<![\w.<>~])(?:[A-Za-z]:)?[\\/](?!\s){FOLDER_PARTS}+")
# Below those of a user, names of folders tell of what they work at.
PERSONAL_FOLDERS = re.compile(rf"(?<=<user folder>)[\\/]{FOLDER_PARTS}*")
# Not in the middle of a path, nor of a sign that stands for one.
PATH_START = r"(?<![\w.<>/\\~-])"
HOME_OR_DOTS = re.compile(rf"{PATH_START}(?:~[\w.-]*|\.{{1,2}})[\\/]{FOLDER_PARTS}*")
# Only a last name with an ending tells a file from a unit, as N/mm.
RELATIVE_FOLDERS = re.compile(rf"{PATH_START}(?:[\w.+@%-]+[\\/])+(?=[\w.+@%-]*\.\w*[A-Za-z]\w*)")
# A shorter user name is part of too many words.
MIN_NAME = 3


def report(model_file: Path | None = None) -> str:
    """The report as TOML, which people and programs read."""
    sections: dict[str, Any] = {
        "report": {"version": REPORT_VERSION, "time": _now()},
        "duhamel": {
            "version": metadata.version("duhamel"),
            "installed": "checkout" if _is_checkout() else "wheel",
        },
        "python": {
            "version": platform.python_version(),
            "implementation": platform.python_implementation(),
            "compiler": platform.python_compiler(),
        },
        "packages": dict(_packages()),
        "machine": dict(_machine()),
        "settings": {name: os.environ[name] for name in REPORTED_VARIABLES if name in os.environ},
        "compiled_code": dict(_compiled_code()),
    }
    if model_file is not None:
        sections["files"] = list(_files(model_file))
    sections["last_failure"] = _failure(last_failure())
    return tomli_w.dumps(sections, multiline_strings=True)


def without_names(text: str, arguments: Sequence[str] = ()) -> str:
    """A text without folders, the user and the machine; names of files stay.

    arguments: of the command, whose folders are taken out where they are relative, too.
    """
    for folder, sign in _known_folders():
        # A folder whose name only begins alike is another one.
        text = re.sub(rf"{re.escape(folder)}(?=[\\/:'\"\n]|$)", sign, text)
    text = PERSONAL_FOLDERS.sub("/", text)
    for word in arguments:
        folder = re.sub(r"[^\\/]*$", "", word)
        if folder.strip("\\/."):
            text = re.sub(PATH_START + re.escape(folder), ".../", text)
    for folders in (ABSOLUTE_FOLDERS, HOME_OR_DOTS, RELATIVE_FOLDERS):
        text = folders.sub(".../", text)
    for name, sign in ((_user(), "<user>"), (platform.node(), "<host>")):
        if len(name) >= MIN_NAME:
            # `_` ends a name, which it does not for \b.
            pattern = rf"(?<![^\W_]){re.escape(name)}(?![^\W_])"
            text = re.sub(pattern, sign, text, flags=re.IGNORECASE)
    return text


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


def _is_checkout() -> bool:
    return _package_folder().joinpath("pyproject.toml").exists()


def _package_folder() -> Path:
    return Path(__file__).resolve().parents[1]


def _known_folders() -> Iterator[tuple[str, str]]:
    """Folders that say where a file is from, the longest first, and what stands for each."""
    folders = {
        str(Path(os.__file__).parent): "<python>",
        sys.prefix: "<environment>",
        str(Path.home()): USER_FOLDER_SIGN,
        tempfile.gettempdir(): USER_FOLDER_SIGN,
        os.getcwd(): USER_FOLDER_SIGN,
        str(_package_folder()): "<duhamel>",
    }
    for folder in sorted(folders, key=len, reverse=True):
        if len(Path(folder).parts) > 1:
            yield folder, folders[folder]


def _user() -> str:
    with suppress(Exception):  # where the system has no names, what it raises depends on Python
        return getpass.getuser()
    return ""


def _packages() -> Iterator[tuple[str, str]]:
    """Versions of all packages that Duhamel requires, those of extras among them."""
    wanted = metadata.requires("duhamel") or ()
    found = (DISTRIBUTION_NAME.match(line) for line in wanted)
    names = {match[0] for match in found if match} - {"duhamel"}
    for name in sorted(names, key=str.lower):
        with suppress(metadata.PackageNotFoundError):
            yield name, metadata.version(name)


def _machine() -> Iterator[tuple[str, Any]]:
    yield "system", f"{platform.system()} {platform.release()}"
    yield "version", platform.version()
    yield "machine", platform.machine()
    with suppress(Exception):  # a report is made of an llvmlite that does not load as well
        from ..solver.compiler.digests import processor

        yield "processor", processor()
    yield "cores", usable_cores()
    yield "memory_available_bytes", available()


def _compiled_code() -> Iterator[tuple[str, Any]]:
    """Which machine code a run would take, and the object files that are kept."""
    try:
        from ..solver import step as step  # all compiled functions are registered now
        from ..solver.compiler.cache import cache_folder
        from ..solver.compiler.digests import checked_code, key
        from ..solver.compiler.object_file import compiler
        from ..solver.compiler.shipped import shipped_code

        yield "compiler", compiler()
        yield "key", key()
        yield "wheel_fits", shipped_code() is not None
        kept = sorted(cache_folder().glob("step-*.o"))
        yield (
            "kept",
            [
                {
                    "name": path.name,
                    "bytes": path.stat().st_size,
                    "whole": checked_code(path.read_bytes()) is not None,
                }
                for path in kept
            ],
        )
    except Exception as error:  # what fails here may be the defect that is reported
        yield "error", without_names(f"{type(error).__name__}: {error}")


def _files(model_file: Path) -> Iterator[dict[str, Any]]:
    """Name, size and digest of a model and of its superelements."""
    named: dict[str, None] = {}
    with suppress(InputError):
        bodies = read_toml(model_file).get("bodies", {})
        tables = bodies.values() if isinstance(bodies, Mapping) else ()
        given = (table.get("superelement") for table in tables if isinstance(table, Mapping))
        named = dict.fromkeys(path for path in given if isinstance(path, str))
    for path in (model_file, *(model_file.parent / name for name in named)):
        try:
            content = path.read_bytes()
        except OSError as error:
            yield {"name": path.name, "error": error.strerror or type(error).__name__}
        else:
            digest = hashlib.sha256(content).hexdigest()
            yield {"name": path.name, "bytes": len(content), "sha256": digest}


def _failure(kept: Mapping[str, Any] | None) -> dict[str, Any]:
    if kept is None:
        return {"error": "none is kept"}
    words = list(map(str, kept["arguments"]))
    return {
        "time": kept["time"],
        "duhamel": kept["duhamel"],
        "arguments": [without_names(word, words) for word in words],
        "error": without_names(kept["error"], words),
        "traceback": without_names(kept["traceback"], words),
    }
