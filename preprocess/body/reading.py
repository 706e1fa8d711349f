"""Body files, of a mesh or matrices, or of a test alone."""

import os
from pathlib import Path
from typing import Any

from ...inputs import InputError, document_of, parse_toml, read_part, read_text
from ...inputs.file_kinds import BODY_FILE, mistaken_for
from ..errors import BodyError
from .body import Body
from .measured_body import MeasuredBody

AnyBody = Body | MeasuredBody


def body_schema(tested: bool = False) -> dict[str, Any]:
    """The JSON schema of body files, by which editors complete and check them.

    Parameters
    ----------
    tested : bool
        Of parts that are known from their test alone, not of a mesh or matrices.

    Returns
    -------
    dict

    Examples
    --------
    >>> schema = body_schema()
    >>> schema["title"], schema["required"]
    ('A body file of Duhamel', ['impulse'])
    """
    if tested:
        return document_of(MeasuredBody, "A body file of a tested part, of Duhamel")
    return document_of(Body, "A body file of Duhamel")


def read_body(path: str | os.PathLike[str]) -> AnyBody:
    """Read a body file, whose paths start from its folder.

    A body without a name has that of its file.

    Parameters
    ----------
    path : path

    Returns
    -------
    Body or MeasuredBody
        The latter of a file whose [measured] has responses, `frf`, in place of a mesh.

    Raises
    ------
    BodyError
        Names the file, the key, what was found and what was expected.

    Examples
    --------
    >>> read_body("no.toml")
    Traceback (most recent call last):
    duhamel.preprocess.errors.BodyError: no.toml: not a readable file: No such file or directory
    """
    text = read_text(path, BodyError)
    try:
        given = parse_toml(text)
        if mistake := mistaken_for(BODY_FILE, given):
            raise InputError(mistake)
        table = {"name": Path(path).stem, **given}
        measured = table.get("measured")
        of_test = isinstance(measured, dict) and "frf" in measured
        read: AnyBody = read_part(table, MeasuredBody) if of_test else read_part(table, Body)
    except InputError as error:
        raise BodyError(f"{path}: {error}") from error
    # Paths in a file start from the file, not from the folder that the command runs in.
    body = read.relative_to(Path(path).parent)
    body.keep(text)
    return body
