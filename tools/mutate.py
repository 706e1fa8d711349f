"""Mutation testing: small faults put into the core one at a time, and whether its tests notice.

    python tools/mutate.py --sample 20 --seconds 1800 solver/step/rows.py ...

A fault is a sign, an operator, a comparison, a constant or a statement that is not there. Each is
tried on a copy of the tree, in processes forked from one that has the libraries loaded: first by
tests that are quick when compiled code runs as plain Python, then by others that compile it. Prints
what survives, then the score of every file.
"""

import os

os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "DUHAMEL_COMPILER": "quick"}

import argparse
import ast
import copy
import random
import resource
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from import_order import PACKAGES, ROOT

PLAIN, COMPILED = {"NUMBA_DISABLE_JIT": "1"}, {"NUMBA_DISABLE_JIT": "0"}
Stage = tuple[dict[str, str], list[str]]
TESTS: dict[str, list[Stage]] = {
    "solver/step": [
        (PLAIN, ["tests/solver/test_rotations.py", "tests/solver/test_tangents.py"]),
        (
            COMPILED,
            [
                "--hypothesis-profile=faults",
                "tests/solver/properties",
                "tests/solver/test_rigid.py",
                "tests/solver/test_springs.py",
                "tests/solver/test_history.py",
                "tests/solver/test_free_flight.py",
                "tests/solver/test_motions.py",
                "tests/solver/test_size.py",
                "tests/solver/test_energy.py",
            ],
        ),
    ],
    "preprocess": [(COMPILED, ["tests/preprocess/responses/test_krylov.py"])],
    "superelement": [(COMPILED, ["tests/superelement"])],
}
LIMIT = 120
"""seconds of processor time for one fault; a fault that takes longer is noticed"""

SWAPPED = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.MatMult: ast.Add,
    ast.FloorDiv: ast.Mult,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
}
REVERSED = {ast.Lt: ast.Gt, ast.LtE: ast.GtE, ast.Gt: ast.Lt, ast.GtE: ast.LtE}


@dataclass(frozen=True)
class Fault:
    """A piece of a file, by its place in the text, and what stands there instead."""

    file: str
    line: int
    first: int
    last: int
    before: str
    after: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.before!r} -> {self.after!r}"

    def applied(self, text: str) -> str:
        return text[: self.first] + self.after + text[self.last :]


def faults(file: str) -> list[Fault]:
    """All faults of a file."""
    text = (ROOT / file).read_text()
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    found = []
    for node, changed in changes(ast.parse(text)):
        first = starts[node.lineno - 1] + node.col_offset
        last = starts[node.end_lineno - 1] + node.end_col_offset
        after = ast.unparse(changed)
        after = after if isinstance(changed, ast.stmt) else f"({after})"
        found.append(Fault(file, node.lineno, first, last, text[first:last], after))
    return found


def changes(tree: ast.Module) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Nodes within functions, each with a faulty one in its place."""
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            for statement in function.body:
                for node in ast.walk(statement):
                    for changed in faulty(node):
                        yield node, changed


def faulty(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.BinOp() | ast.AugAssign() | ast.BoolOp():
            if type(node.op) in SWAPPED:
                yield with_field(node, "op", SWAPPED[type(node.op)]())
        case ast.Compare(ops=[operator]):
            for kind in (SWAPPED.get(type(operator)), REVERSED.get(type(operator))):
                if kind:
                    yield with_field(node, "ops", [kind()])
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node.operand
        case ast.Constant(value=bool()):
            yield ast.Constant(not node.value)
        case ast.Constant(value=int()):
            yield ast.Constant(node.value + 1)
        case ast.Constant(value=float()):
            yield ast.Constant(2.0 * node.value if node.value else 1.0)
    if isinstance(node, ast.AugAssign) or (
        isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    ):
        yield ast.Pass()
    if isinstance(node, ast.Assign) and not isinstance(node.targets[0], ast.Name | ast.Tuple):
        yield ast.Pass()


def with_field(node: ast.AST, field: str, value: object) -> ast.AST:
    changed = copy.copy(node)
    setattr(changed, field, value)
    return changed


def copied(folder: Path) -> Path:
    """A copy of the tree that is imported as the sources are, without build and results."""
    tree = folder / "tree"
    ignored = shutil.ignore_patterns("build", ".git", ".venv*", "__pycache__", "*.h5", "out")
    shutil.copytree(ROOT, tree, ignore=ignored)
    (tree / "types" / "duhamel").mkdir(parents=True)
    for package in PACKAGES:
        (tree / "types" / "duhamel" / package).symlink_to(tree / package)
    return tree


def load_libraries() -> None:
    """What the tests need but the sources: loaded once, for all processes."""
    import h5py  # noqa: F401
    import matplotlib  # noqa: F401
    import meshio  # noqa: F401
    import pydantic  # noqa: F401
    import pytest  # noqa: F401
    import rslab  # noqa: F401
    import scipy.spatial.transform  # noqa: F401
    import skfem  # noqa: F401


def noticed(tree: Path, file: str, without: list[str]) -> bool:
    """True if a test fails."""
    left_out = [f"--deselect={test}" for test in without]
    return any(fails(tree, setting, tests + left_out) for setting, tests in stages_of(file))


def fails(tree: Path, environment: dict[str, str], tests: list[str]) -> bool:
    """True if one of these tests fails, in a process of its own."""
    child = os.fork()
    if child:
        _, status = os.waitpid(child, 0)
        return status != 0
    try:
        os._exit(_run(tree, environment, tests))
    except BaseException:
        traceback.print_exc()
    finally:
        # Whatever happens, it happens here and not in the caller's frames.
        os._exit(1)


def _run(tree: Path, environment: dict[str, str], tests: list[str]) -> int:
    """The exit code of pytest in this process, whose output goes to the file `log`."""
    import pytest

    log = os.open(tree / "log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.chdir(tree)
    resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
    sys.path[:0] = [str(tree / "types")]
    os.environ |= environment
    os.environ |= {"PYTHONPATH": str(tree / "types"), "DUHAMEL_CACHE": str(tree / "cache")}
    return int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *tests]))


def stages_of(file: str) -> list[Stage]:
    return next(stages for folder, stages in TESTS.items() if file.startswith(folder))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("files", nargs="+")
    parser.add_argument("--sample", type=int, default=20, help="faults of each file")
    parser.add_argument("--seconds", type=float, default=1800.0, help="to stop after")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--deselect", action="append", default=[], help="tests that fail anyway")
    chosen = parser.parse_args()

    sys.dont_write_bytecode = True
    load_libraries()
    draw, end = random.Random(chosen.seed), time.monotonic() + chosen.seconds
    tried = []
    for file in chosen.files:
        every = faults(file)
        tried += draw.sample(every, min(chosen.sample, len(every)))
    draw.shuffle(tried)
    score: dict[str, Counter[str]] = {file: Counter() for file in chosen.files}
    with tempfile.TemporaryDirectory() as folder:
        tree = copied(Path(folder))
        for file in {str(stages_of(file)): file for file in chosen.files}.values():
            if noticed(tree, file, chosen.deselect):
                sys.exit(f"{(tree / 'log').read_text()}\n{file}: fails without a fault")
        for fault in tried:
            if time.monotonic() > end:
                break
            sound = (tree / fault.file).read_text()
            (tree / fault.file).write_text(fault.applied(sound))
            killed = noticed(tree, fault.file, chosen.deselect)
            (tree / fault.file).write_text(sound)
            score[fault.file]["noticed" if killed else "survived"] += 1
            if not killed:
                print(fault, flush=True)
    for file, counts in score.items():
        print(f"{file}: {counts['noticed']} of {counts.total()} faults noticed")


if __name__ == "__main__":
    main()
