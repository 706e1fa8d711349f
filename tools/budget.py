"""What the sources weigh, and whether that is more than was agreed.

    python tools/budget.py            # print the counts, fail where one exceeds tools/budget.toml
    python tools/budget.py --accept   # write counts that fell as the new limits

The limits may only fall. To raise one, edit tools/budget.toml and say why there.
"""

import argparse
import ast
import io
import re
import sys
import tokenize
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIMITS = ROOT / "tools" / "budget.toml"
PACKAGES = (
    *("files", "inputs", "superelement", "cad", "results", "preprocess", "solver", "view", "study"),
    *("robots", "fmu", "cli"),
    "top",
)
COUPLINGS = ROOT / "solver" / "couplings"
CONSTANT = re.compile(r"[A-Z][A-Z0-9_]+")
AT_LEAST = {"comments per 100 lines of code"}
"""counts that are to be high"""


class Source:
    """A file of the product, parsed."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.text = path.read_text(encoding="utf-8")
        self.tree = ast.parse(self.text)

    def names(self) -> Iterator[str]:
        """Names that the module defines: classes, functions, constants, aliases of types."""
        for node in self.tree.body:
            if isinstance(node, ast.ClassDef | ast.FunctionDef):
                yield node.name
            elif isinstance(node, ast.Assign):
                yield from (target.id for target in node.targets if isinstance(target, ast.Name))
            elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                yield node.target.id

    def comments(self) -> int:
        """Lines of comments, without orders to linters and type checkers."""
        tokens = tokenize.generate_tokens(io.StringIO(self.text).readline)
        comments = (token.string for token in tokens if token.type == tokenize.COMMENT)
        return sum(not re.match(r"#\s*(noqa|type:|!)", comment) for comment in comments)

    def code(self) -> int:
        """Lines that are neither blank, nor a comment, nor part of a docstring."""
        lines = self.text.splitlines()
        blank = {n for n, line in enumerate(lines, 1) if not line.strip() or line.strip()[0] == "#"}
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Expr) and _is_text(node.value):
                blank |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        return len(lines) - len(blank)

    def exported(self) -> int:
        """The names in `__all__` of a package."""
        for node in self.tree.body:
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
                return len(ast.literal_eval(node.value))
        return 0

    def asks_kind(self, kinds: set[str]) -> int:
        """Calls of isinstance with one of some classes."""
        return sum(
            isinstance(node, ast.Call)
            and ast.unparse(node.func) == "isinstance"
            and bool(kinds & set(re.findall(r"\w+", ast.unparse(node.args[1]))))
            for node in ast.walk(self.tree)
        )


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def count() -> dict[str, float]:
    sources = [Source(path) for name in PACKAGES for path in sorted((ROOT / name).rglob("*.py"))]
    names = Counter(name for source in sources for name in set(source.names()))
    public = {name: n for name, n in names.items() if not name.startswith("_")}
    constants = [n for s in sources for n in s.names() if CONSTANT.fullmatch(n)]
    kinds = {
        node.name
        for source in sources
        if source.path.is_relative_to(COUPLINGS)
        for node in source.tree.body
        if isinstance(node, ast.ClassDef)
    }
    packages = [source for source in sources if source.path.parent.parent == ROOT]
    code = sum(source.code() for source in sources)
    return {
        "lines of the product": sum(len(source.text.splitlines()) for source in sources),
        "exported names": sum(s.exported() for s in packages if s.path.name == "__init__.py"),
        "constants of one word": sum("_" not in name for name in constants),
        "names in more than one module": sum(n > 1 for n in public.values()),
        "isinstance on couplings": sum(
            source.asks_kind(kinds)
            for source in sources
            if not source.path.is_relative_to(COUPLINGS)
        ),
        "comments per 100 lines of code": round(
            100.0 * sum(source.comments() for source in sources) / code, 2
        ),
    }


def exceeds(name: str, found: float, limit: float) -> bool:
    return found < limit if name in AT_LEAST else found > limit


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--accept", action="store_true", help="write counts that fell as limits")
    accept = parser.parse_args().accept
    text = LIMITS.read_text(encoding="utf-8")
    limits, found, failed = tomllib.loads(text), count(), []
    for name, value in found.items():
        limit = limits[name]
        mark = "more than agreed" if exceeds(name, value, limit) else ""
        print(f"{name:34}{value:>10g}   limit {limit:>8g}   {mark}".rstrip())
        if mark:
            failed.append(name)
        elif accept:
            text = re.sub(rf'(?m)^("{name}" = )\S+', rf"\g<1>{value:g}", text)
    if accept:
        LIMITS.write_text(text, encoding="utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
