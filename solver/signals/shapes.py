"""Shapes from 0 to 1 that profiles are made of, with derivatives and integrals in closed form."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..arrays import Array


class Terms(NamedTuple):
    """A shape s, s', s'' and its integrals from 0, at 0 <= x <= 1."""

    value: Array
    rate: Array
    acceleration: Array
    once: Array
    twice: Array


Shape = Callable[[Array], Terms]


def ramp(x: Array) -> Terms:
    """s = x."""
    return Terms(x, np.ones_like(x), np.zeros_like(x), x**2 / 2.0, x**3 / 6.0)


def quintic(x: Array) -> Terms:
    """s = 10 x^3 - 15 x^4 + 6 x^5."""
    return Terms(
        x**3 * (10.0 - 15.0 * x + 6.0 * x**2),
        30.0 * x**2 * (1.0 - x) ** 2,
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
        x**4 * (2.5 - 3.0 * x + x**2),
        x**5 * (0.5 - 0.5 * x + x**2 / 7.0),
    )


def raised_cosine(x: Array) -> Terms:
    """s = (1 - cos(pi x)) / 2."""
    sine, cosine = np.sin(np.pi * x), np.cos(np.pi * x)
    return Terms(
        # (1 - cos(pi x)) / 2 without cancellation.
        np.sin(0.5 * np.pi * x) ** 2,
        0.5 * np.pi * sine,
        0.5 * np.pi**2 * cosine,
        0.5 * (x - sine / np.pi),
        0.25 * x**2 - (np.sin(0.5 * np.pi * x) / np.pi) ** 2,
    )


def half_wave(x: Array) -> Terms:
    """s = sin(pi x), which ends at 0."""
    # sin(pi) is 1e-16: after the pulse the load is exactly zero.
    sine = np.where(x < 1.0, np.sin(np.pi * x), 0.0)
    return Terms(
        sine,
        np.pi * np.cos(np.pi * x),
        -(np.pi**2) * sine,
        2.0 / np.pi * np.sin(0.5 * np.pi * x) ** 2,
        (x - sine / np.pi) / np.pi,
    )


def rise(shape: Shape, t: Array, start: float, duration: float) -> Array:
    """A shape over a time, its derivatives and its antiderivatives (5, ...).

    Before it is 0, after it its last value; without a duration it is a jump.
    """
    past = np.maximum(t - start - duration, 0.0)
    lasts = duration > 0.0
    x = np.clip((t - start) / duration, 0.0, 1.0) if lasts else np.where(t < start, 0.0, 1.0)
    inside = (t >= start) & (t < start + duration)
    value, rate, acceleration, once, twice = shape(x)
    last = shape(np.ones(1))
    # After the end the value stays, so that its antiderivatives go on as a line and a parabola.
    end, area, moment = (float(term[0]) for term in (last.value, last.once, last.twice))
    scale = 1.0 / duration if lasts else 0.0
    return np.stack(
        [
            value,
            np.where(inside, rate * scale, 0.0),
            np.where(inside, acceleration * scale**2, 0.0),
            np.where(past > 0.0, area, once) * duration + end * past,
            np.where(past > 0.0, moment, twice) * duration**2
            + area * duration * past
            + 0.5 * end * past**2,
        ]
    )
