"""What tests of the sources share."""

import signal
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import pytest
from import_order import modules


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--complete", action="store_true", help="what would be skipped is missing: an error"
    )


SLOW = Path(__file__).parent / "slow.txt"
"""tests that take more than a second, a line each, without their parameters, and files of many; in
the order in which files begin. The first needs compiled code, and the next do not wait for it"""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what is listed as slow, and begin with its files, that none is left for the end."""
    listed = dict.fromkeys(SLOW.read_text(encoding="utf-8").split())
    files = {file: i for i, file in enumerate(dict.fromkeys(map(_file, listed)))}
    for item in items:
        if item.nodeid.partition("[")[0] in listed or _file(item.nodeid) in listed:
            item.add_marker("slow")
    items.sort(key=lambda item: files.get(_file(item.nodeid), len(files)))


def _file(test: str) -> str:
    return test.partition("::")[0]


@pytest.fixture(autouse=True)
def _interrupts_are_those_of_python() -> Generator[None]:
    """Also where the shell has them ignored, and after a library has put its own in their place."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Generator[None, Any, Any]:
    return _complete(collector.config, (yield))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, Any, Any]:
    return _complete(item.config, (yield))


def _complete(config: pytest.Config, report: Any) -> Any:
    """The report, of a failure where a test or a file would be skipped but must not be."""
    if report.skipped and config.getoption("complete") and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped, but must not be (--complete): {report.longrepr[2]}"
    return report


@pytest.fixture(scope="session")
def files_and_folders() -> Callable[[str], set[str]]:
    """The names of the files and folders of a folder that hold Python files."""

    def listed(folder: str) -> set[str]:
        inside = tuple(folder.split("/"))
        depth = len(inside)
        return {module[depth] for module in modules(inside[0]) if module[:depth] == inside}

    return listed
