"""Compile the time step for the machines of wheels, into solver/compiler/shipped_steps.

    python tools/make_shipped_steps.py [--derivatives]

Wheels take these files along, so that a first run compiles nothing; those of releases also with
derivatives, which takes minutes. Each has the key of its sources before it: where they have changed
since, it is not used.
"""

import sys

from duhamel.solver import step as step  # all compiled functions are registered now
from duhamel.solver.compiler.digests import key, with_digest
from duhamel.solver.compiler.object_file import object_files
from duhamel.solver.compiler.shipped import SHIPPED_FOLDER, shipped_name
from duhamel.solver.compiler.targets import SHIPPED_TARGETS, SHIPPED_WITH_DERIVATIVES


def main() -> None:
    SHIPPED_FOLDER.mkdir(exist_ok=True)
    targets = [*SHIPPED_TARGETS]
    if sys.argv[1:] == ["--derivatives"]:
        targets += SHIPPED_WITH_DERIVATIVES
    for target, code in object_files(targets).items():
        content = key(target).encode() + b"\n" + with_digest(code)
        SHIPPED_FOLDER.joinpath(shipped_name(target)).write_bytes(content)


if __name__ == "__main__":
    main()
