"""The responses of interfaces and of channels, taken apart."""

from dataclasses import replace

import numpy as np

from ...superelement import Channels, Kernel
from ...superelement.validation import Array
from ..assembly.channels import ChannelRows
from .impulse import ImpulseResponses


def channels_of(
    rows: ChannelRows, n_c: int, responses: ImpulseResponses, H: Array, B: Array
) -> Channels:
    """The channels of a body from the responses of both, compliance H and accelerance B.

    Patterns that do not deform the body, which the responses leave out, are zero.
    """
    n = len(rows.deforming)
    if responses.modes is not None:
        phi = np.zeros((n, len(responses.modes.omega)))
        phi[rows.deforming] = responses.modes.phi[n_c:]
        return Channels(rows.patterns, rows.sensors, phi)
    # Patterns that only accelerate the body were left out of the responses.
    place = np.concatenate([np.arange(n_c), n_c + np.flatnonzero(rows.deforming)])
    kernel = responses.kernel
    return Channels(
        rows.patterns,
        rows.sensors,
        kernel=replace(
            kernel,
            g=_filled(kernel.g, place, n_c + n),
            g_initial=_filled(kernel.g_initial, place, n_c + n),
        ),
        compliance=_filled(H, place, n_c + n),
        accelerance=_filled(B, place, n_c + n),
    )


def of_interfaces(
    n_c: int, responses: ImpulseResponses, H: Array, B: Array
) -> tuple[ImpulseResponses, Array, Array]:
    """The responses, H and B of the interfaces alone, the first of the rows."""
    kernel: Kernel = replace(
        responses.kernel,
        g=responses.kernel.g[:, :n_c, :n_c],
        g_initial=responses.kernel.g_initial[:, :n_c, :n_c],
    )
    modes = responses.modes
    if modes is not None:
        modes = replace(modes, phi=modes.phi[:n_c])
    return replace(responses, kernel=kernel, modes=modes), H[:n_c, :n_c], B[:n_c, :n_c]


def _filled(A: Array, place: Array, n: int) -> Array:
    """Rows and columns of matrices (..., k, k) at their places among n, zero elsewhere."""
    full = np.zeros((*A.shape[:-2], n, n))
    full[..., place[:, None], place] = A
    return full
