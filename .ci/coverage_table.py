"""Statements and branches that tests took, a line for each package and each room of the two walks.

python .ci/coverage_table.py build/ci/.coverage
"""

import json
import subprocess
import sys
from collections import Counter
from pathlib import Path, PurePath

COUNTS = ("num_statements", "covered_lines", "num_branches", "covered_branches")


def room(file: str) -> str:
    """As `solver/step`: the package, and the folder or file in it."""
    inside = PurePath(file).with_suffix("").parts
    return "/".join(inside[inside.index("duhamel") + 1 :][:2])


def share(part: int, whole: int) -> str:
    return f"{100 * part / whole:6.1f} %" if whole else "       -"


def main(data: str) -> None:
    report = Path(data).with_suffix(".json")
    subprocess.run(
        [sys.executable, "-m", "coverage", "json", "-q", f"--data-file={data}", "-o", report],
        check=True,
    )
    counts: dict[str, Counter[str]] = {}
    for file, found in json.loads(report.read_text())["files"].items():
        for group in (room(file), room(file).partition("/")[0], "all"):
            summary = {count: found["summary"][count] for count in COUNTS}
            counts.setdefault(group, Counter()).update(summary)
    print(f"{'':32} statements    taken   branches    taken")
    for group, found in sorted(counts.items()):
        statements, lines, branches, taken = (found[count] for count in COUNTS)
        print(
            f"{group:32} {statements:10} {share(lines, statements)} "
            f"{branches:10} {share(taken, branches)}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
