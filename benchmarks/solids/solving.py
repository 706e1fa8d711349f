"""What the solutions of a Krylov space take."""

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import Any
from unittest import mock

from .measuring import Measurement


@contextlib.contextmanager
def counted() -> Iterator[Measurement]:
    """Seconds before the first solve, and of solves; blocks, and iterations of all solves."""
    from duhamel.preprocess.responses.krylov import KrylovSpace
    from duhamel.preprocess.solving.factor import Factor
    from duhamel.preprocess.solving.mixed import MixedFactor
    from duhamel.preprocess.solving.refined import RefinedGradients

    spent: Measurement = {"set-up": 0.0, "solves": 0.0, "blocks": 0, "iterations": 0}
    create, grow = KrylovSpace.__init__, KrylovSpace.grow

    def created(self: Any, *arguments: Any, **keywords: Any) -> None:
        start, solves = time.perf_counter(), spent["solves"]
        create(self, *arguments, **keywords)
        spent["set-up"] = time.perf_counter() - start - (spent["solves"] - solves)

    def grown(self: Any) -> bool:
        spent["blocks"] += 1
        return grow(self)

    def timed(solve: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        def solved(self: Any, b: Any) -> Any:
            start = time.perf_counter()
            x = solve(self, b)
            spent["solves"] += time.perf_counter() - start
            spent["iterations"] += getattr(self, "iterations", [0])[-1]
            return x

        return solved

    with (
        mock.patch.object(KrylovSpace, "__init__", created),
        mock.patch.object(KrylovSpace, "grow", grown),
        mock.patch.object(Factor, "__call__", timed(Factor.__call__)),
        mock.patch.object(MixedFactor, "__call__", timed(MixedFactor.__call__)),
        mock.patch.object(RefinedGradients, "__call__", timed(RefinedGradients.__call__)),
    ):
        yield spent
