"""Curves of one run or of several in one picture."""

import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import repeat
from pathlib import Path

import numpy as np

from ..results import QuantityError, Results, SeriesError
from ..results.transforms import Window, split
from ..results.wildcards import WILDCARD_STAR, named, of_all
from .curve import Curve
from .errors import PictureError, PictureWarning
from .quantities import AGAINST_WORD, curves

# Of one panel, by a star: more cannot be told apart.
MAX_STAR_CURVES = 12
# The last word of names that `duhamel run` gives, which tells nothing apart.
RESULTS_ENDING = "results"


@dataclass(frozen=True, eq=False)
class Run:
    """Results with the name that they have in a legend, see `panel` for an example.

    Parameters
    ----------
    name : str
    results : Results
    source : str
        Their file, in messages.
    """

    name: str
    results: Results
    source: str


def runs_of(files: Sequence[Path], names: Sequence[str] = ()) -> list[Run]:
    """Read results files, by the names given, or by what tells the files apart.

    Parameters
    ----------
    files : sequence of Path
    names : sequence of str

    Raises
    ------
    PictureError
        If there is not one name for each file, each another.
    ResultsError
        For a file that holds no results.

    Examples
    --------
    >>> from duhamel import view
    >>> view.runs_of([])
    []
    """
    files = list(dict.fromkeys(files))
    if names and len(names) != len(files):
        raise PictureError(f"expected a name for each of {len(files)} files, found {len(names)}")
    if len(set(names)) < len(names):
        raise PictureError(f"expected a name for each file, found the same twice: {names}")
    told = [name.strip() for name in names] or names_of(files)
    return [
        Run(name, Results.read(file), str(file)) for name, file in zip(told, files, strict=True)
    ]


def names_of(files: Sequence[Path]) -> list[str]:
    """Find what tells the paths of files apart.

    Words at the beginning and at the end that all have are left out, unless a number alone or
    nothing would remain. "" of a single file.

    Examples
    --------
    >>> from duhamel import view
    >>> from pathlib import Path
    >>> view.names_of([Path("case1-paper-results.h5"), Path("case1-consistent-results.h5")])
    ['paper', 'consistent']
    """
    if len(files) < 2:
        return [""] * len(files)
    stems = [str(file.resolve().with_suffix("")) for file in files]
    if len(set(stems)) < len(stems):
        return [file.name for file in files]
    rows = [re.findall(r"[^/_-]+|[/_-]", stem) for stem in stems]
    end = _alike([row[::-1] for row in rows])
    rows = [row[: len(row) - end] if end else row for row in rows]
    start = _alike(rows)
    while start and not all(map(_is_telling, _from(rows, start))):
        start -= 1
    return _from(rows, start)


def _from(rows: Sequence[Sequence[str]], start: int) -> list[str]:
    return [
        re.sub(rf"[-_]{RESULTS_ENDING}$", "", "".join(row[start:]).strip("/_-")) for row in rows
    ]


def _is_telling(name: str) -> bool:
    return bool(name) and not name.isdecimal()


def _alike(rows: Sequence[Sequence[str]]) -> int:
    """How many words the rows share from their beginning."""
    count = 0
    for words in zip(*rows, strict=False):
        if len(set(words)) > 1:
            break
        count += 1
    return count


def panel(
    runs: Sequence[Run], text: str, gravities: bool = False, window: Window | None = None
) -> list[Curve]:
    """Evaluate the curves of a panel, of quantities joined by commas, of all runs.

    Of a quantity that some runs lack the others are drawn, and `PictureWarning` names the lacking
    ones; so it is told where a star stands for more than can be drawn.

    Parameters
    ----------
    runs : sequence of Run
    text : str
        "velocity:hub:x,velocity:rod:x", "acceleration:*:z".
    gravities : bool
        Accelerations in g.
    window : (float, float) [s], optional

    Examples
    --------
    >>> from duhamel import view
    >>> import duhamel as du
    >>> m = du.Mechanism(gravity=[0.0, 0.0, -10.0])
    >>> ball = m.add(du.RigidBody(1.0, [0.1, 0.1, 0.1]), name="ball")
    >>> results = m.simulate(1.0, step=0.1).results
    >>> [curve.words for curve in view.panel([view.Run("", results, "ball.h5")], "velocity:*")]
    [('velocity', 'ball', 'z')]
    """
    found: list[Curve] = []
    for quantity in split(text):
        every = list(_of_all(runs, quantity, gravities, window))
        found += _largest(every, quantity) if WILDCARD_STAR in quantity else every
    return found


def _of_all(
    runs: Sequence[Run], quantity: str, gravities: bool, window: Window | None
) -> Iterator[Curve]:
    failures: list[tuple[Run, QuantityError | SeriesError]] = []
    for run in runs:
        try:
            found = _of(run.results, quantity, gravities, window)
        except (QuantityError, SeriesError) as error:
            failures.append((run, error))
            continue
        time = run.results.time
        for curve in found:
            if len(runs) > 1:
                abscissa = time if curve.abscissa is None else curve.abscissa
                curve = replace(curve, run=run.name, abscissa=abscissa)
            yield curve
    if len(failures) == len(runs):
        run, why = failures[0]
        raise why if len(runs) == 1 else type(why)(f"{run.source}: {why}") from why
    for run, why in failures:
        warnings.warn(f"{run.source}: {why}", PictureWarning, stacklevel=2)


def _of(results: Results, quantity: str, gravities: bool, window: Window | None) -> list[Curve]:
    """The curves of all that the stars of a quantity stand for, of which one at least is there."""
    expanded = _expanded(results, quantity)
    return of_all(expanded, lambda one: curves(results, one, gravities, window))


def _expanded(results: Results, quantity: str) -> list[str]:
    """All that a quantity stands for; of one against another both stars stand for the same."""
    sides = [side.strip() for side in quantity.split(AGAINST_WORD, 1)]
    if len(sides) == 1:
        return named(results, quantity)
    ys, xs = (named(results, side) for side in sides)
    if len(xs) > 1 and _owners(xs) != _owners(ys):
        raise QuantityError(f"{quantity}: expected stars that stand for the same on both sides")
    pairs = zip(ys, xs if len(xs) > 1 else repeat(xs[0]), strict=False)
    return [f"{y}{AGAINST_WORD}{x}" for y, x in pairs]


def _owners(quantities: Sequence[str]) -> list[str]:
    return [quantity.partition(":")[2].rpartition(":")[0] for quantity in quantities]


def _largest(found: list[Curve], quantity: str) -> list[Curve]:
    """Not more curves than can be told apart: those with the largest values of any run."""
    peaks: dict[tuple[str, ...], float] = {}
    for curve in found:
        peak = float(np.abs(curve.values).max(initial=0.0))
        peaks[curve.words] = max(peak, peaks.get(curve.words, 0.0))
    runs = len({curve.run for curve in found})
    most = max(1, MAX_STAR_CURVES // runs)
    if len(peaks) <= most:
        return found
    kept = sorted(peaks, key=lambda words: -peaks[words])[:most]
    warnings.warn(
        f"{quantity}: stands for {len(peaks)} curves, of which the {most} largest are drawn",
        PictureWarning,
        stacklevel=2,
    )
    return [curve for curve in found if curve.words in kept]
