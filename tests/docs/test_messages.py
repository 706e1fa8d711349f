"""The messages that are explained are those of the program."""

import re

import pytest
from import_order import PACKAGES, ROOT

PAGE = ROOT / "docs" / "how-to" / "messages.md"


def sources() -> str:
    """All sources, texts that stand side by side joined, and what is filled in left out."""
    files = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    return re.sub(r"\"\s*f?\"", "", text)


def explained() -> list[str]:
    """Messages of the first column, without what "…" stands for."""
    text = PAGE.read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.*?) \| ", text, re.M)
    return [m.replace("\\|", "|") for row in rows for m in re.findall(r"`([^`]+)`", row)]


SOURCES = sources()


@pytest.mark.parametrize("message", explained())
def test_a_message_that_is_explained_exists(message: str) -> None:
    missing = [part for part in message.split("…") if part.strip(" :;,.()") and part not in SOURCES]
    assert missing == []
