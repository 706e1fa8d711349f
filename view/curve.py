"""Curves of pictures: numbers over time, over frequency, or over another number."""

from dataclasses import dataclass

import numpy as np

from ..superelement.validation import Array

PLANE_PAPERS = ("plane", "space")


@dataclass(frozen=True, eq=False)
class Curve:
    """One number over time, over frequency, or over another number.

    Parameters
    ----------
    words : tuple of str
        Its kind, its owners, its axis, what was made of it.
    unit : str
    values : (n,)

    Examples
    --------
    >>> import numpy as np
    >>> from duhamel import view
    >>> curve = view.Curve(("velocity", "hub", "x"), "m/s", np.zeros(3))
    >>> curve.base, curve.paper
    ('s', 'lines')
    """

    words: tuple[str, ...]
    unit: str
    values: Array
    """(n,)"""
    abscissa: Array | None = None
    """(n,), unless it is the time of all curves of a picture"""
    base: str = "s"
    """the unit of the abscissa, s or Hz, or that of another quantity"""
    ordinate: str = ""
    """what the values are, where the kind does not say it"""
    paper: str = "lines"
    """lines, log, bands or tripartite; of two quantities plane, or space for a way in space"""
    along: str = ""
    """what stands between the kind and the axis: "about" """
    run: str = ""
    """the name of its run, where there are several"""
    across: "Curve | None" = None
    """the quantity of its abscissa, if that is one"""
    band: float = np.inf
    """of a spectrum: the frequency up to which the superelement is right [Hz]"""
