"""Frequency responses and static influence coefficients of a linear model."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import ModelError
from .equations import Equations, Factors, Forcing
from .inputs import Channel, forcing
from .outputs import Observation, observe


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Amplitudes of outputs per unit of inputs. See `linearize` for an example.

    Parameters
    ----------
    frequencies : (n,) [Hz]
    values : (n, n_out, n_in) complex
    outputs, inputs : tuple of str
        A vector has a name for each component.
    units, input_units : tuple of str
    """

    frequencies: Array
    values: NDArray[np.complex128]
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    units: tuple[str, ...]
    input_units: tuple[str, ...]

    @property
    def magnitude(self) -> Array:
        return np.abs(self.values)

    @property
    def phase(self) -> Array:
        """[rad]"""
        return np.angle(self.values)


def frequency_response(
    equations: Equations, inputs: Sequence[Channel], quantities: Sequence[str], frequencies: Array
) -> FrequencyResponse:
    """Responses at frequencies (n,) [Hz]; `ModelError` at one where the model resonates."""
    if frequencies.ndim != 1 or not (np.isfinite(frequencies).all() and (frequencies >= 0.0).all()):
        raise ModelError("frequencies: expected numbers >= 0 in Hz, one after the other")
    observation = observe(equations, quantities, inputs)
    forces = forcing(equations.pose, inputs)
    values = np.zeros((len(frequencies), len(observation.names), len(inputs)), dtype=np.complex128)
    for k, frequency in enumerate(frequencies.tolist()):
        values[k] = amplitudes(equations, observation, forces, 2j * np.pi * frequency)
    return _named(frequencies, values, observation, inputs)


def static_response(
    equations: Equations, inputs: Sequence[Channel], quantities: Sequence[str]
) -> FrequencyResponse:
    observation = observe(equations, quantities, inputs)
    # A real s keeps all matrices real: half the memory and exact zeros.
    values = amplitudes(equations, observation, forcing(equations.pose, inputs), 0.0)
    return _named(np.zeros(1), values[None] + 0j, observation, inputs)


def _named(
    frequencies: Array, values: Any, observation: Observation, inputs: Sequence[Channel]
) -> FrequencyResponse:
    return FrequencyResponse(
        frequencies,
        values,
        observation.names,
        tuple(channel.name for channel in inputs),
        observation.units,
        tuple(channel.unit for channel in inputs),
    )


def amplitudes(equations: Equations, observation: Observation, forces: Forcing, s: complex) -> Any:
    """Outputs (n_out, n_in) per unit of inputs at a complex frequency, real at a real one."""
    factors = equations.factorized(s)
    if not factors.conditioned:
        at = f"{abs(s) / (2.0 * np.pi):.6g} Hz"
        raise ModelError(
            f"no finite response at {at}: an undamped resonance, or a motion that nothing resists"
        )
    return observed(factors, observation, forces)


def observed(factors: Factors, observation: Observation, forces: Forcing) -> Any:
    """Outputs (n_out, n_in) by equations that are factorized."""
    found = factors.forced(forces)
    u = factors.equations.elastic_dofs(factors.s, found.pi)
    q = np.vstack([found.xi, u])
    return observation.at(factors.s, q, found.lam, np.eye(forces.r.shape[1]))
