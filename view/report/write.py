"""Writing a report whole, and never in the place of the results."""

import os
from pathlib import Path

from ...files.outputs import AnyPath, clash, renamed_when_whole
from ...results import Results
from ..errors import PictureError, require_target
from .libraries import package
from .page import OnPart, page

PAGE_SUFFIXES = (".html", ".htm")


def write_report(
    results: Results,
    path: str | os.PathLike[str],
    title: str = "",
    field: str = "",
    on_part: OnPart | None = None,
) -> None:
    """Write the report of a run as one page of HTML, whole or not at all.

    It needs no network and no other file: the motion in space, plots that zoom, tables of validity,
    peaks, contacts, balances and bodies, and where everything comes from.

    Parameters
    ----------
    results : Results
    path : path
        .html or .htm.
    title : str
        The name of the results file, unless given.
    field : {"von_mises", "displacement", "velocity", "pressure"}, optional
        For the colors of the animation; by default the first of them that is known.
    on_part : callable, optional
        Is told how many parts are made, of how many.

    Raises
    ------
    PictureError
        Where it cannot be written, would replace the results or a superelement, or where the
        packages of the extra `report` are missing.

    Examples
    --------
    >>> from duhamel import view
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> view.write_report(results, "ball.html", title="A ball that falls")
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
    require_target(path, PAGE_SUFFIXES)
    superelements = (file.path for file in results.superelement_files.values())
    inputs: dict[AnyPath, str] = dict.fromkeys(superelements, "a superelement")
    inputs[results.name] = "the results file"
    if found := clash([path], inputs):
        raise PictureError(f"{found}, which the report would replace")
