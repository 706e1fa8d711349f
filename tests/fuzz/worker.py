"""Reads damaged files one after the other, in a process that may die of them.

python -m tests.fuzz.worker TARGET FIRST NUMBER FOLDER

Before each file a line with its number, after it a line with the answer.
"""

import resource
import sys
from pathlib import Path

from .mutations import mutated
from .targets import Target, attempt, targets

MEMORY = 4 << 30
"""bytes of address space"""


def damaged(target: Target, number: int) -> tuple[str, bytes]:
    """The suffix and the bytes of the damaged file of a number."""
    suffixes = sorted(target.seeds)
    suffix = suffixes[number % len(suffixes)]
    seeds = target.seeds[suffix]
    if target.inside is not None and number % 3:
        return suffix, target.inside(number, seeds[number % len(seeds)])
    return suffix, mutated(number, seeds)


def main(name: str, first: int, count: int, folder: Path) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    target = targets(folder)[name]
    print("ready", flush=True)
    for number in range(first, first + count):
        suffix, data = damaged(target, number)
        path = folder / f"input{suffix}"
        path.write_bytes(data)
        print(number, flush=True)
        print(attempt(target, path).replace("\n", " "), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), Path(sys.argv[4]))
