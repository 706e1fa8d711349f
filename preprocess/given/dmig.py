"""Matrices that Nastran punches as bulk data: cards DMIG (.pch, .dmig).

The head DMIG, NAME, 0, IFO, TIN, TOUT, POLAR, blank, NCOL; then for each column DMIG, NAME, GJ, CJ,
blank and for each entry G, C, A, B. IFO = 6: symmetric, of which one half is given; 1: square; a
component 0 or blank is that of a scalar point. Source: MSC Nastran Quick Reference Guide, DMIG.
"""

from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp

from ..errors import MatrixError, MeshError
from ..mesh.formats.nastran_deck import Card, read_cards
from ..mesh.mesh import IntArray
from .labels import numbered
from .matrix_names import chosen_name

SYMMETRIC_FORM, SQUARE_FORM = 6, 1
_FORMS = (SQUARE_FORM, SYMMETRIC_FORM)
_REAL = (1, 2)
FIRST_ENTRY, ENTRY_FIELDS = 6, 4  # the field of the first entry of a column, and those of each


def read_dmig(path: Path, names: tuple[str, ...]) -> tuple[Any, IntArray]:
    """The matrix (n, n), sparse, of the first of some names that is there, or of the only one.

    Of a symmetric one the half that the file has. With it the label and direction (n, 2) of each
    row, which is 0 for scalar points. `MatrixError`.
    """
    try:
        cards = [card for card in read_cards(path, {}) if card.name == "DMIG"]
        heads = {card.text(2): card for card in cards if card.text(3) == "0"}
        name = chosen_name(heads, names)
        _check(heads[name], name)
        columns = [card for card in cards if card.text(2) == name and card is not heads[name]]
        return _matrix(columns)
    except MeshError as error:  # of the cards, which meshes have too
        raise MatrixError(str(error)) from error


def _check(head: Card, name: str) -> None:
    form, kind = head.integer(4), head.integer(5)
    if form not in _FORMS:
        raise MatrixError(
            f"{head.location}: matrix {name}: expected a square or symmetric one, IFO = 1 or 6, "
            f"found {form}"
        )
    if kind not in _REAL:
        raise MatrixError(
            f"{head.location}: matrix {name}: expected real numbers, TIN = 1 or 2, found {kind}"
        )


def _matrix(columns: list[Card]) -> tuple[Any, IntArray]:
    rows, values, owner = [], [], []
    for number, card in enumerate(columns):
        last = len(card.fields) + 2
        for field in range(FIRST_ENTRY, last, ENTRY_FIELDS):
            # The rest of a line is blank behind the last entry.
            if card.text(field):
                rows.append(_dof(card, field))
                values.append(card.number(field + 2))
                owner.append(number)
    if not values:
        raise MatrixError("expected entries of the matrix, found none")
    # Columns may have dofs that no row has, and the other way round.
    heads = [_dof(card, 3) for card in columns]
    dofs, number_of = numbered(np.array([*rows, *heads], dtype=np.int64))
    row, column = number_of[: len(rows)], number_of[len(rows) :][owner]
    return sp.coo_array((values, (row, column)), shape=(len(dofs), len(dofs))), dofs


def _dof(card: Card, field: int) -> tuple[int, int]:
    """The label and the direction in two fields; a blank one is that of a scalar point."""
    return card.integer(field), card.integer(field + 1, 0)
