"""The elements of a mesh, dealt out to processes so that neighbors stay together."""

from itertools import pairwise
from typing import Any

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from ..mesh.facets import Facets
from ..mesh.mesh import IntArray


def neighbors(facets: Facets) -> Any:
    """The graph (n_elements, n_elements), sparse, of the elements that have a facet in common."""
    sides = list(facets.sides.values())
    owner = np.repeat(
        np.arange(sum(len(numbers) for numbers in sides)),
        np.concatenate([np.full(len(numbers), numbers.shape[1]) for numbers in sides]),
    )
    facet = np.concatenate([numbers.ravel() for numbers in sides])
    order = np.argsort(facet, kind="stable")
    # A facet has two elements at most, so sorted ones stand side by side.
    shared = np.flatnonzero(np.diff(facet[order]) == 0)
    one, other = owner[order[shared]], owner[order[shared + 1]]
    n = int(owner[-1]) + 1
    half = sp.coo_array((np.ones(len(one)), (one, other)), shape=(n, n)).tocsr()
    return half + half.T


def partition(comm: Any, graph: Any | None) -> IntArray | None:
    """The process (n_elements,) of every element, in the first process; None in the others.

    graph: `neighbors`, needed in the first alone. By PTScotch: parts of the same size with few
    facets between them.
    """
    rows = comm.scatter(None if graph is None else _shares(graph, comm.size))
    first, last = rows.shape[0], rows.shape[1]
    adjacency = PETSc.Mat().createAIJ(
        ((first, last), (first, last)), csr=petsc_rows(rows), comm=comm
    )
    adjacency.assemble()
    adjacency.convert("mpiadj")
    partitioning = PETSc.MatPartitioning().create(comm)
    partitioning.setAdjacency(adjacency)
    partitioning.setType("ptscotch")
    numbers = PETSc.IS().create(comm)
    partitioning.apply(numbers)
    parts = comm.gather(numbers.getIndices().astype(np.int64))
    for made in (numbers, partitioning, adjacency):
        made.destroy()
    return None if parts is None else np.concatenate(parts)


def _shares(graph: Any, size: int) -> list[Any]:
    """As many rows of a graph for each process."""
    edges = np.linspace(0, graph.shape[0], size + 1).astype(int).tolist()
    return [graph[low:high] for low, high in pairwise(edges)]


def petsc_rows(rows: Any) -> tuple[Any, Any, Any]:
    """Sparse rows as PETSc takes them, with its type of integers."""
    kind = PETSc.IntType
    return rows.indptr.astype(kind), rows.indices.astype(kind), rows.data
