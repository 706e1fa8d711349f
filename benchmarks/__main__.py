"""All benchmarks, one after the other, each in a process of its own.

What they print goes to the terminal and to build/benchmarks.md, under the machine, with the command
of each program. The last table has their seconds. A program that fails does not stop the others.
Run as `python benchmarks [--small] [--only NAME ...]`; `--small` has the smallest settings of each,
which show that it works and no more.
"""

import argparse
import os
import platform
import resource
import subprocess
import sys
import time
from datetime import datetime
from importlib import metadata
from pathlib import Path
from typing import NamedTuple, TextIO

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "build" / "benchmarks.md"
PACKAGES = ("duhamel", "numpy", "numba", "scipy", "exudyn", "ngsolve", "mujoco", "drake", "pin")
# What each program takes: as docs/performance.md has it, and at its smallest.
PROGRAMS = {
    "time_loop": ("", "--bodies 1 2"),
    "history": ("--steps 10000 1000000 --dofs 6 24 --modes 60", "--steps 100 --dofs 6 --modes 60"),
    "real_time": ("", "2000"),
    "derivatives": ("", ""),
    "beside_exudyn": ("--large", "--repeats 1 --small"),
    "published": ("", "--repeats 1 --only Bricard"),
    "contact_beside_exudyn": ("", "--repeats 1"),
    "fast_rotation": ("", "--repeats 1"),
    "beside_robotics": ("", "--repeats 1"),
    "why_impulses": ("", ""),
    "beside_explicit": ("", "--repeats 1 --cases rod"),
    "surface_steps": ("", "--only 144"),
    "assembly": ("--large", "--small"),
    "preprocess": ("--sizes 20 50 100 160", "--sizes 20 --patience 20"),
    "large": ("--sizes 100 160 285 500 --solvers auto iterative", "--sizes 20 --solvers auto"),
    "reduction": ("8", "5"),
    "mesh_and_test": ("", ""),
    "beside_lmfbs": ("", ""),
}


class Took(NamedTuple):
    command: str
    wall: float
    cpu: float
    load: float
    status: int


def machine() -> list[str]:
    """Processor, memory, system, date, commit and packages."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True
    )
    versions = []
    for name in PACKAGES:
        try:
            versions.append(f"{name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            versions.append(f"no {name}")
    return [
        "# Benchmarks",
        "",
        f"{processor()}, {os.cpu_count()} cores, {memory:.0f} GB, {platform.platform()}",
        f"{datetime.now():%Y-%m-%d %H:%M}, commit {commit.stdout.strip() or 'unknown'}",
        f"Python {platform.python_version()}, {', '.join(versions)}",
    ]


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or platform.machine())


def run(name: str, arguments: str, page: TextIO) -> Took:
    command = f"python benchmarks/{name}.py {arguments}".strip()
    say(page, "", f"## {name}", "", f"    {command}", "")
    load, began = os.getloadavg()[0], time.perf_counter()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with subprocess.Popen(
        [sys.executable, f"benchmarks/{name}.py", *arguments.split()],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        for line in process.stdout or ():
            say(page, line.rstrip("\n"))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Took(command, time.perf_counter() - began, cpu, load, process.returncode)


def say(page: TextIO, *lines: str) -> None:
    for line in lines:
        print(line, flush=True)
        print(line, file=page, flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--small", action="store_true", help="the smallest settings of each")
    parser.add_argument("--only", nargs="*", choices=PROGRAMS, default=list(PROGRAMS))
    chosen = parser.parse_args()
    PAGE.parent.mkdir(exist_ok=True)
    with PAGE.open("w") as page:
        say(page, *machine())
        took = [run(name, PROGRAMS[name][chosen.small], page) for name in chosen.only]
        say(page, "", "## Seconds", "")
        say(page, "| command | clock | CPU | load before | |", "|---|---|---|---|---|")
        for row in took:
            result = "failed" if row.status else ""
            say(
                page,
                f"| `{row.command}` | {row.wall:.0f} s | {row.cpu:.0f} s | {row.load:.1f} "
                f"| {result} |",
            )
        total = f"{sum(row.wall for row in took):.0f} s | {sum(row.cpu for row in took):.0f} s"
        say(page, f"| all | {total} | | |")
    print(f"\n{PAGE}")
    return int(any(row.status for row in took))


if __name__ == "__main__":
    sys.exit(main())
