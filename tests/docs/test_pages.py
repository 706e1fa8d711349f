"""Links and names of files on the pages lead somewhere, and the orders there are those kept."""

import re
import runpy

import pytest
from import_order import PACKAGES, ROOMS, ROOT

PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), ROOT / "docs" / "llms.txt"])
BASES = ("", "solver", "solver/compiler")
"""Folders that paths of the developers' pages are relative to."""


def anchors(text: str) -> set[str]:
    """Anchors of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", text, flags=re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if "://" in link:
            continue
        file, _, anchor = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target.read_text()), link


def test_every_example_is_in_the_gallery():
    text = (ROOT / "docs" / "gallery.md").read_text()
    examples = [*(ROOT / "examples").glob("*.toml"), *(ROOT / "examples").glob("*.py")]
    assert [path.name for path in examples if f"](../examples/{path.name})" not in text] == []


def test_every_problem_of_validation_is_on_its_page():
    text = (ROOT / "docs" / "validation.md").read_text()
    problems = (ROOT / "tests" / "validation").glob("test_*.py")
    assert [path.name for path in problems if f"`{path.name}`" not in text] == []


def test_every_benchmark_is_run_and_on_its_page():
    programs = runpy.run_path(str(ROOT / "benchmarks" / "__main__.py"))["PROGRAMS"]
    files = {path.stem for path in (ROOT / "benchmarks").glob("*.py")} - {"__main__"}
    assert set(programs) == files
    text = (ROOT / "docs" / "performance.md").read_text()
    commands = [f"{name}.py {programs[name][0]}".strip() for name in programs]
    assert [command for command in commands if f"`{command}`" not in text] == []


def test_files_that_are_named_exist():
    text = re.sub(r"```.*?```", "", (ROOT / "docs" / "architecture.md").read_text(), flags=re.S)
    named = {word for word in re.findall(r"`([\w./]+\.(?:py|toml|md))`", text) if "/" in word}
    assert named
    missing = [n for n in named if not any((ROOT / base / n).exists() for base in BASES)]
    assert missing == []


def test_the_orders_are_those_that_are_kept():
    text = (ROOT / "docs" / "architecture.md").read_text()
    block = re.search(r"^    packages .*?\n\n", text, flags=re.M | re.S)
    assert block is not None
    orders: dict[str, list[str]] = {}
    for line in block[0].splitlines():
        key, *words = re.findall(r"\w+", line) or [""]
        if line.startswith("    ") and line[4:5].isalpha():
            orders[key] = words
            last = key
        elif key:
            orders[last] += [key, *words]
    assert orders["packages"] == list(PACKAGES)
    for walk in ("preprocess", "solver"):
        assert orders[walk] == [room for room in ROOMS[walk] if not room.startswith("__")]
