"""What a file is that was given in place of another one, for the line that refuses it."""

from collections.abc import Mapping
from typing import Any, NamedTuple


class TomlKind(NamedTuple):
    """A kind of TOML file: what it is called, keys that it alone has, and what takes it."""

    name: str
    keys: frozenset[str]
    use: str


MODEL_FILE = TomlKind(
    "a model file",
    frozenset({"simulation", "bodies", "joints", "ground"}),
    "duhamel run simulates it",
)
BODY_FILE = TomlKind(
    "a body file",
    frozenset({"mesh", "matrices", "interfaces", "impulse", "measured"}),
    "duhamel preprocess makes a superelement of it",
)
STUDY_FILE = TomlKind(
    "a study file",
    frozenset({"model", "body", "outputs", "parameters"}),
    "duhamel sweep, fit or optimize takes it",
)
FILE_KINDS = (MODEL_FILE, BODY_FILE, STUDY_FILE)
# The first bytes of files that are no text, or none in TOML.
BEGINNINGS_OF_FILES = {
    b"\x89HDF": "an HDF5 file: duhamel info tells what is in it",
    b"ISO-10303-21": "a CAD file: duhamel import makes body files and a model of it",
}


def mistaken_for(wanted: TomlKind, document: Mapping[str, Any]) -> str:
    """The message about a file of another kind; "" for what may be one of the wanted kind."""
    if wanted.keys & document.keys():
        return ""
    for kind in FILE_KINDS:
        if kind.keys & document.keys():
            return f"expected {wanted.name}, found {kind.name}: {kind.use}"
    return ""


def told_by_beginning(content: bytes) -> str:
    """What a file is by its first bytes; "" where they do not tell."""
    return next(
        (what for head, what in BEGINNINGS_OF_FILES.items() if content.startswith(head)), ""
    )
