"""Cases that count how often they are begun, one of which kills the process that works on it, and
cases that look for sockets where somebody could reach it.
"""

import os
import signal
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from duhamel.study import Case


@dataclass(frozen=True)
class Deadly:
    name: str
    paths = ()
    columns = ()
    failures = ()

    def check(self, base: Path, outputs: Mapping[str, str]) -> None:
        pass

    def size(self, base: Path) -> int:
        return 0

    def units(self, case: Case, outputs: Mapping[str, str]) -> dict[str, str]:
        return {}

    def make(self, case: Case) -> None:
        with (case.folder / f"{case.name}.lives").open("a") as file:
            file.write("1")
        if case.name == self.name:
            os.kill(os.getpid(), signal.SIGKILL)

    def is_made(self, case: Case) -> bool:
        return False

    def numbers(self, case: Case, outputs: Mapping[str, str]) -> dict[str, float]:
        return {}


class Listening(Deadly):
    def make(self, case: Case) -> None:
        """Note the listening sockets of this process and of the one that waits for it."""
        own = {link for pid in (os.getpid(), os.getppid()) for link in _descriptors(pid)}
        found = sorted(own & set(_listening()))
        (case.folder / f"{case.name}.listens").write_text(str(found))


def _descriptors(pid: int) -> Iterator[str]:
    for entry in os.scandir(f"/proc/{pid}/fd"):
        with suppress(OSError):
            yield os.readlink(entry)


def _listening() -> Iterator[str]:
    """Sockets of the machine to which others may connect. Source: proc(5)."""
    for name in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A":
                yield f"socket:[{fields[9]}]"
    for line in Path("/proc/net/unix").read_text().splitlines()[1:]:
        fields = line.split()
        if int(fields[3], 16) & 0x10000:
            yield f"socket:[{fields[6]}]"


class Greedy(Deadly):
    """Cases that lack memory where another one runs, and one that always does."""

    failures = (MemoryError,)

    def make(self, case: Case) -> None:
        count = case.folder / f"{case.name}.lives"
        with count.open("a") as file:
            file.write("1")
        if case.name == self.name or len(count.read_text()) == 1:
            raise MemoryError(case.name)
