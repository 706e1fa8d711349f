"""What a shell completes: the files that a command reads, by their suffixes."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

Completion = Callable[[str], list[str]]


def files(*suffixes: str) -> Completion:
    """Completes paths of files of these suffixes, and of folders on the way to them."""

    def complete(incomplete: str) -> list[str]:
        return list(_beginning(incomplete, suffixes))

    return complete


def _beginning(incomplete: str, suffixes: tuple[str, ...]) -> Iterator[str]:
    """Paths that begin as a word does; the only folder is entered, for a shell ends the word."""
    head, slash, start = incomplete.rpartition("/")
    found: list[str] = []
    folders: list[str] = []
    with suppress(OSError, ValueError):
        for path in sorted(Path(head + slash or ".").expanduser().iterdir()):
            # Hidden files are offered to those who type their dot, as shells do.
            if not path.name.startswith(start) or (path.name.startswith(".") and not start):
                continue
            if path.is_dir():
                folders.append(f"{head}{slash}{path.name}/")
            elif path.suffix.lower() in suffixes:
                found.append(f"{head}{slash}{path.name}")
    if not found and len(folders) == 1:
        yield from _beginning(folders[0], suffixes)
    else:
        yield from [*found, *folders]
