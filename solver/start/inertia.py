"""Matrices of inverse inertia of bodies and of accelerance of interfaces, and scales of both."""

import numpy as np

from ..arrays import Array
from ..lower.lower import LoweredModel
from ..step.system import System
from .matrices import Matrix, block_diagonal, is_small

NO_MOTION = 1e-14
"""eigenvalues of an accelerance, over its largest, that are rounding: of interfaces that move as
one"""


def inverse_inertia(system: System) -> Matrix:
    """M^-1 of (x, Theta) of all bodies (6 n_b, 6 n_b)."""
    inverse = np.linalg.inv(system.bodies.J_rot).astype(np.float64, copy=False)
    return _of_bodies(system, 1.0 / system.bodies.mass, inverse)


def inverse_root(system: System) -> Matrix:
    """L with L L^T = M^-1 (6 n_b, 6 n_b)."""
    root = np.linalg.cholesky(np.linalg.inv(system.bodies.J_rot))
    return _of_bodies(system, 1.0 / np.sqrt(system.bodies.mass), root)


def geometric_scale(system: System) -> Matrix:
    """Scales of (x, Theta) of all bodies whereby the rows of joints are geometry alone.

    1 for displacements, 1 / l for rotations; l: the longest lever or the radius of gyration of a
    body. Masses, which may differ by many digits, are not in it (6 n_b, 6 n_b).
    """
    bodies, frames = system.bodies, system.frames
    length = np.sqrt(np.trace(bodies.J_rot, axis1=1, axis2=2) / bodies.mass)
    moving = frames.body >= 0
    # Several frames of a body compete; plain indexing would keep the last.
    np.maximum.at(length, frames.body[moving], np.linalg.norm(frames.X[moving], axis=1))
    return _of_bodies(system, np.ones(len(length)), np.eye(3) / length[:, None, None])


def interface_accelerance(lowered: LoweredModel) -> Matrix:
    """A_el: accelerations of all active dofs under unit loads on them, at rest (n_a, n_a)."""
    return block_diagonal(_accelerances(lowered), is_small(lowered.system))


def elastic_accelerations(lowered: LoweredModel, p: Array) -> Array:
    """Accelerations (n_a,) of active dofs under the loads p (n_u,) at rest, patterns included."""
    elastic = lowered.system.elastic
    accelerations = np.zeros(len(p))
    for e, accelerance in enumerate(lowered.responses.accelerances):
        dofs = slice(elastic.dof[e], elastic.dof[e + 1])
        accelerations[dofs] = accelerance @ p[dofs]
    active: Array = accelerations[elastic.active]
    return active


def accelerance_root(lowered: LoweredModel) -> Matrix:
    """A with A A^T = A_el times the mass of each body, all dofs as lengths (n_a, n_a)."""
    elastic, roots = lowered.system.elastic, []
    lengths = np.split(elastic.length, elastic.active_range[1:-1])
    for accelerance, length, element in zip(
        _accelerances(lowered), lengths, lowered.superelements, strict=False
    ):
        values, vectors = np.linalg.eigh(element.mass * length[:, None] * accelerance * length)
        # Interfaces that move as one have zero eigenvalues, whose rounding may be negative.
        values[values < NO_MOTION * values.max(initial=0.0)] = 0.0
        roots.append(vectors * np.sqrt(values))
    return block_diagonal(roots, is_small(lowered.system))


def _accelerances(lowered: LoweredModel) -> list[Array]:
    elastic = lowered.system.elastic
    accelerances = []
    for e, accelerance in enumerate(lowered.responses.accelerances):
        begin, end = elastic.active_range[e], elastic.active_range[e + 1]
        dofs = elastic.active[begin:end] - elastic.dof[e]
        accelerances.append(accelerance[np.ix_(dofs, dofs)])
    return accelerances


def _of_bodies(system: System, linear: Array, angular: Array) -> Matrix:
    n = len(linear)
    blocks = np.zeros((n, 6, 6))
    blocks[:, :3, :3] = linear[:, None, None] * np.eye(3)
    blocks[:, 3:, 3:] = angular
    if is_small(system):
        return block_diagonal(list(blocks), small=True)
    from scipy.sparse import bsr_array, csr_array

    return csr_array(bsr_array((blocks, np.arange(n), np.arange(n + 1))))
