"""Damage by stress histories: rainflow counting, Woehler lines and Miner's rule, all by pyLife.

A run is taken as one of many repetitions. Its rainflow cycles are those that close within it, and
those that its residue closes when it follows itself. The damage of a cycle is one over the cycles
to failure at its amplitude, which a mean stress raises (FKM). The damages of all cycles add up.

pyLife is the extra `fatigue` of duhamel; it loads pandas, so that it is imported where it is used.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import chain
from typing import Any, Literal, get_args

import numpy as np

from ..files.arrays import Array, IntArray
from ..superelement import Recovery
from ..superelement.cells import normals, triangles
from .errors import ExportError, RecoveryError, SeriesError
from .results import Results

Rule = Literal["elementary", "haibach", "original"]
CountedStress = Literal["normal", "mises", "principal"]
N_PLANES = 18
"""planes through the normal of a surface on which cycles are counted: one for each 10 degrees"""
N_PLANES_AT_EDGES = 200
"""planes of all directions, 10 degrees apart, where a surface has an edge and no normal"""
MIN_SMOOTH_COSINE = 0.94
"""cosine of the angle between normals of facets and of their mean, above which it is no edge"""
MAX_STRESS_NUMBERS = 1 << 19
"""of stresses in memory together"""
SHARE_BELOW_R0 = 3.0
"""M over the mean stress sensitivity of pulsating tension, FKM guideline 4.4.2"""


@dataclass(frozen=True)
class WoehlerLine:
    """Cycles to failure by the amplitude of stress: N = cycles (amplitude / limit)^-slope.

    Parameters
    ----------
    limit : float [Pa]
        The amplitude at the knee, for a mean stress of zero; of other histories in their unit.
    cycles : float
        N at the knee.
    slope : float
        k, above the knee.
    rule : {"elementary", "haibach", "original"}
        Below the knee: the same slope, the slope 2 k - 1, or no damage.
    mean_stress : float
        M of the FKM guideline, 0 to 1: a mean stress s_m adds M s_m to an amplitude, as far as R
        is below 0, and a third of that beyond. 0: mean stresses have no effect.

    Raises
    ------
    SeriesError
        For numbers that mean nothing; the message names them.

    Examples
    --------
    >>> WoehlerLine(120e6, slope=5.0).rule
    'elementary'
    """

    limit: float
    cycles: float = 1e6
    slope: float = 5.0
    rule: Rule = "elementary"
    mean_stress: float = 0.0

    def __post_init__(self) -> None:
        for name in ("limit", "cycles"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise SeriesError(
                    f"{name}: expected a positive number, got {getattr(self, name):g}"
                )
        if not 1.0 <= self.slope <= 100.0:
            raise SeriesError(f"slope: expected a number from 1 to 100, got {self.slope:g}")
        if not 0.0 <= self.mean_stress <= 1.0:
            raise SeriesError(
                f"mean_stress: expected a number from 0 to 1, got {self.mean_stress:g}"
            )
        if self.rule not in get_args(Rule):
            expected = ", ".join(get_args(Rule))
            raise SeriesError(f"rule: expected one of {expected}, got {self.rule!r}")

    def damages(self, amplitude: Array, mean: Array) -> Array:
        """The damage (c,) of one cycle each, of amplitudes and mean stresses (c,)."""
        _require_pylife()
        import pandas as pd
        from pylife.materiallaws import WoehlerCurve
        from pylife.strength.meanstress import fkm_goodman

        damaging = amplitude > 0.0
        if not damaging.any():
            return np.zeros_like(amplitude)
        load = amplitude[damaging]
        # Without a sensitivity the transformation is the identity, at the cost of a table.
        if self.mean_stress > 0.0:
            M = self.mean_stress
            load = fkm_goodman(load, mean[damaging], M, M / SHARE_BELOW_R0, -1.0)
        curve = WoehlerCurve(pd.Series({"SD": self.limit, "ND": self.cycles, "k_1": self.slope}))
        if self.rule != "original":
            curve = getattr(curve, f"miner_{self.rule}")()
        damages = np.zeros_like(amplitude)
        # pyLife has an infinite number of cycles where there is no damage.
        damages[damaging] = 1.0 / curve.cycles(np.maximum(load, np.finfo(float).tiny))
        return damages


def rainflow(history: Array) -> tuple[Array, Array]:
    """Amplitudes and means (c,) of the rainflow cycles of a history (n,) that repeats itself.

    Raises
    ------
    ExportError
        Without pyLife.
    SeriesError
        For a history with what is no number.

    Examples
    --------
    >>> amplitude, mean = rainflow(np.array([0.0, 3.0, 1.0, 2.0, 0.0]))
    >>> sorted(zip(amplitude.tolist(), mean.tolist()))
    [(0.5, 1.5), (1.5, 1.5)]
    """
    if not np.isfinite(history).all():
        raise SeriesError("rainflow: expected finite numbers")
    # The residue grows and falls again, so that no cycle of it closes by itself.
    within, residue = _closed(history)
    # What is left over closes when the history follows itself.
    across, _ = _closed(np.concatenate([residue, residue]))
    ends = np.vstack([within, across])
    return 0.5 * np.abs(ends[:, 1] - ends[:, 0]), 0.5 * (ends[:, 0] + ends[:, 1])


def _closed(history: Array) -> tuple[Array, Array]:
    """Ends (c, 2) of the cycles that close within a history, and its residue."""
    _require_pylife()
    from pylife.stress.rainflow import FourPointDetector, LoopValueRecorder

    recorder = LoopValueRecorder()
    detector = FourPointDetector(recorder)
    detector.process(np.ascontiguousarray(history, dtype=float))
    ends = np.column_stack([recorder.values_from, recorder.values_to]).reshape(-1, 2)
    return ends.astype(float), np.asarray(detector.residuals, dtype=float)


def damage(history: Array, line: WoehlerLine) -> float:
    """The damage of one passage of a history (n,); failure is expected at 1.

    Examples
    --------
    >>> wave = 100e6 * np.sin(np.linspace(0.0, 20.0 * np.pi, 2001))
    >>> round(damage(wave, WoehlerLine(100e6, cycles=1e6)) * 1e6, 6)
    10.0
    """
    return float(_damages([history], line)[0])


def _damages(histories: Iterable[Array], line: WoehlerLine) -> Array:
    """The damage (k,) of each of some histories."""
    cycles = [rainflow(history) for history in histories]
    of_history = np.repeat(np.arange(len(cycles)), [len(amplitude) for amplitude, _ in cycles])
    # A call of pyLife takes a millisecond, so that the cycles of all histories are in one.
    each = line.damages(*(np.concatenate(parts) for parts in zip(*cycles, strict=True)))
    total: Array = np.bincount(of_history, each, len(cycles)).astype(float)
    return total


@dataclass(frozen=True, eq=False)
class DamageField:
    """The damage of a run at the points of the surface of a body, see `damage_field`.

    Parameters
    ----------
    body : str
    points : (p, 3) [m]
        In body axes, from the center of mass.
    damage : (p,)
    nodes : (p,) of int, optional
        The numbers of the nodes in the mesh file.
    duration : float [s]
        Of the run.
    """

    body: str
    points: Array
    damage: Array
    nodes: IntArray | None
    duration: float

    @property
    def worst(self) -> int:
        """The point of the largest damage."""
        return int(self.damage.argmax())

    @property
    def repetitions(self) -> float:
        """How often the run can be repeated until failure; infinite without damage."""
        largest = float(self.damage.max())
        return 1.0 / largest if largest > 0.0 else np.inf

    @property
    def life(self) -> float:
        """The time until failure [s]."""
        return self.repetitions * self.duration


def damage_field(
    results: Results,
    body: str,
    line: WoehlerLine,
    criterion: CountedStress = "normal",
    rows: slice = slice(None),
    progress: Callable[[int], None] | None = None,
) -> DamageField:
    """Compute the damage of a run at all points of the surface of a body.

    Parameters
    ----------
    results : Results
        Of a run that gives stresses of the body (`[recovery] stress = true`).
    body : str
    line : WoehlerLine
    criterion : {"normal", "mises", "principal"}
        The history that is counted: the normal stress on the plane across the surface on which the
        damage is largest (critical plane, every 10 degrees; at edges of all directions); the
        equivalent stress of von Mises with the sign of the principal stress of the largest
        magnitude; or that principal stress itself. The last two lose their meaning where the
        principal axes turn, and their sign in pure shear.
    rows : slice
        Of the recorded steps.
    progress : callable, optional
        Told how many points are done now.

    Returns
    -------
    DamageField

    Raises
    ------
    ExportError
        Without pyLife.
    RecoveryError
        Where the run does not give stresses.
    """
    if criterion not in get_args(CountedStress):
        expected = ", ".join(get_args(CountedStress))
        raise SeriesError(f"criterion: expected one of {expected}, got {criterion!r}")
    _require_pylife()
    recovery, time = results.recoverable(body), results.time[rows]
    if len(time) < 2:
        raise SeriesError(f"fatigue: expected two or more recorded steps, found {len(time)}")
    planes = _planes(recovery, body) if criterion == "normal" else [None] * len(recovery.points)
    found = np.zeros(len(recovery.points))
    batch = max(1, MAX_STRESS_NUMBERS // (6 * len(time)))
    for first in range(0, len(found), batch):
        some = slice(first, min(first + batch, len(found)))
        stress = results.stress_history(body, some, rows)
        # One point after the other: at an edge it has hundreds of histories.
        histories = chain.from_iterable(
            _histories(own, criterion, across)
            for own, across in zip(stress.swapaxes(0, 1), planes[some], strict=True)
        )
        # Of the histories of a point the worst one counts.
        counts = [1 if across is None else len(across) for across in planes[some]]
        starts = np.cumsum([0, *counts])[:-1]
        found[some] = np.maximum.reduceat(_damages(histories, line), starts)
        if progress is not None:
            progress(some.stop - first)
    return DamageField(body, recovery.points, found, recovery.nodes, float(time[-1] - time[0]))


def _histories(stress: Array, criterion: str, planes: Array | None) -> Array:
    """The histories (k, n) that are counted at a point, of its stresses (n, 6)."""
    if planes is None:
        from pylife.stress import equistress

        name = {"mises": "signed_mises_abs_max_principal", "principal": "abs_max_principal"}
        xx, yy, zz, yz, xz, xy = stress.T
        equivalent: Array = getattr(equistress, name[criterion])(xx, yy, zz, xy, xz, yz)
        return equivalent[None]
    x, y, z = planes.T
    # n . sigma n by the components xx, yy, zz, yz, xz, xy
    weights = np.stack([x * x, y * y, z * z, 2.0 * y * z, 2.0 * x * z, 2.0 * x * y])
    return np.ascontiguousarray((stress @ weights).T)


def _planes(recovery: Recovery, body: str) -> list[Array | None]:
    """Normals (k, 3) of the planes at each point: across the surface, or all of them at edges."""
    corners = triangles(recovery.cells)
    if not len(corners):
        raise RecoveryError(f"body {body!r}: expected a surface of solids, found no facets")
    n, vectors = np.zeros_like(recovery.points), normals(recovery.points, corners)
    for corner in corners.T:
        np.add.at(n, corner, vectors)
    n /= np.maximum(np.linalg.norm(n, axis=1), np.finfo(float).tiny)[:, None]
    vectors /= np.maximum(np.linalg.norm(vectors, axis=1), np.finfo(float).tiny)[:, None]
    flattest = np.ones(len(n))
    for corner in corners.T:
        np.minimum.at(flattest, corner, (vectors * n[corner]).sum(axis=1))
    everywhere = _hemisphere(N_PLANES_AT_EDGES)
    return [
        _across(normal) if flat > MIN_SMOOTH_COSINE else everywhere
        for normal, flat in zip(n, flattest.tolist(), strict=True)
    ]


def _across(normal: Array) -> Array:
    """Directions (k, 3) across a unit normal."""
    # The axis least along the normal is the safest to be projected.
    first = np.eye(3)[np.abs(normal).argmin()]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    angles = np.arange(N_PLANES)[:, None] * np.pi / N_PLANES
    directions: Array = np.cos(angles) * first + np.sin(angles) * np.cross(normal, first)
    return directions


def _hemisphere(count: int) -> Array:
    """Directions (k, 3), evenly over half of a sphere, on a spiral by the golden angle."""
    # Normals of opposite signs are the same plane, so that half of a sphere has all.
    z = (np.arange(count) + 0.5) / count
    turn = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - z * z)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])


def _require_pylife() -> Any:
    try:
        import pylife
    except ImportError as error:
        raise ExportError(f"fatigue needs {error.name}: pip install 'duhamel[fatigue]'") from error
    return pylife
