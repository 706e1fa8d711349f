"""The requirements of the project with some of its extras, one a line.

python tools/requirements.py test gallery

pip takes no hashes for a folder, so it is given the names beside constraints.txt, which has them.
"""

import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]


def required(extra: str) -> Iterator[str]:
    """What an extra asks for, with that of the extras that it names."""
    for requirement in PROJECT["optional-dependencies"][extra]:
        if requirement.startswith(own := f"{PROJECT['name']}["):
            for other in requirement.removeprefix(own).rstrip("]").split(","):
                yield from required(other.strip())
        else:
            yield requirement


def main(*extras: str) -> None:
    lines = [*PROJECT["dependencies"], *(line for extra in extras for line in required(extra))]
    print("\n".join(dict.fromkeys(lines)))


if __name__ == "__main__":
    main(*sys.argv[1:])
