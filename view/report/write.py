"""Writing a report whole, and never in the place of the results."""

import os
from pathlib import Path

from ...files.outputs import AnyPath, clash, renamed_when_whole
from ...results import Results
from ..errors import PictureError, require_target
from .libraries import package
from .page import OnPart, page

SUFFIXES = (".html", ".htm")


def write_report(
    results: Results,
    path: str | os.PathLike[str],
    title: str = "",
    field: str = "",
    on_part: OnPart | None = None,
) -> None:
    """Write the report of a run as one page of HTML.

    It needs no network and no other file: the motion in space, plots that zoom, tables of validity,
    peaks, contacts, balances and bodies, and where everything comes from. title: the name of the
    results file, unless given. field: "von_mises", "displacement" or "velocity" for the colors of
    the animation; by default the first of them that is known. on_part: told how many parts are
    made, of how many. The file appears whole or not at all. Raises PictureError where it cannot be
    written, would replace the results or a superelement, or where the packages of the extra
    `report` are missing.
    """
    path = Path(path)
    _check(results, path)
    for name in ("plotly", "k3d", "jinja2"):
        package(name)
    text = page(results, title, field, on_part)
    with renamed_when_whole(path, failure=PictureError) as temporary:
        # Names of files may hold bytes that are no text, which UTF-8 has no code for.
        temporary.write_text(text, encoding="utf-8", errors="backslashreplace", newline="\n")


def _check(results: Results, path: Path) -> None:
    require_target(path, SUFFIXES)
    superelements = (file.path for file in results.superelement_files.values())
    inputs: dict[AnyPath, str] = dict.fromkeys(superelements, "a superelement")
    inputs[results.name] = "the results file"
    if found := clash([path], inputs):
        raise PictureError(f"{found}, which the report would replace")
