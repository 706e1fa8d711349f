"""What tests of the sources share."""

from collections.abc import Callable

import pytest
from import_order import modules


@pytest.fixture(scope="session")
def files_and_folders() -> Callable[[str], set[str]]:
    """The names of the files and folders of a folder that hold Python files."""

    def listed(folder: str) -> set[str]:
        inside = tuple(folder.split("/"))
        depth = len(inside)
        return {module[depth] for module in modules(inside[0]) if module[:depth] == inside}

    return listed
