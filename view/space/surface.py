"""How the facets of a body are shaded: smooth, but for its sharp edges, which are drawn."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...superelement.cells import IntArray
from ...superelement.validation import Array
from ..errors import PictureError

# Between neighboring triangles, from which on their edge is sharp [degrees]: fillets stay smooth.
SHARP_ANGLE = 35.0
# VTK would turn triangles around that it takes for wrong, and colors belong to points as they are.
AS_THEY_ARE: dict[str, Any] = {
    "consistent_normals": False,
    "auto_orient_normals": False,
    "cell_normals": False,
}
# By its number of points, in meshio's order.
POINTS_AROUND_FACET = {
    3: (0, 1, 2),
    4: (0, 1, 2, 3),
    6: (0, 3, 1, 4, 2, 5),
    8: (0, 4, 1, 5, 2, 6, 3, 7),
    9: (0, 4, 1, 5, 2, 6, 3, 7),
}


def pyvista() -> Any:
    """The library; `PictureError` without it."""
    try:
        import pyvista
    except ImportError as error:
        raise PictureError("duhamel animate needs pyvista: pip install 'duhamel[view]'") from error
    return pyvista


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles with points that are doubled along sharp edges.

    copies (q,): which point of the body each one is; triangles (m, 3): rows of them; edges (e, 2):
    the sharp ones, as rows of points of the body; closed: it encloses something and turns outwards,
    so that its insides are never seen.
    """

    copies: IntArray
    triangles: IntArray
    edges: IntArray
    closed: bool


def surface(points: Array, triangles: IntArray) -> Surface:
    """Triangles (m, 3) of points (p, 3) at rest, split along sharp edges."""
    whole = pyvista().PolyData.from_regular_faces(points, triangles)
    # Filters pass data of points on: so it is known where each point of the result comes from.
    whole.point_data["from"] = np.arange(len(points))
    split = whole.compute_normals(split_vertices=True, feature_angle=SHARP_ANGLE, **AS_THEY_ARE)
    sharp = whole.extract_feature_edges(SHARP_ANGLE, manifold_edges=False)
    edges = sharp.point_data["from"][sharp.lines.reshape(-1, 3)[:, 1:]]
    return Surface(split.point_data["from"], split.regular_faces, edges, _is_closed(whole))


def point_normals(points: Array, triangles: IntArray) -> Array:
    """Unit normals (q, 3) at points (q, 3), the means of those of the triangles there."""
    mesh = pyvista().PolyData.from_regular_faces(points, triangles)
    found: Array = mesh.compute_normals(split_vertices=False, **AS_THEY_ARE).point_data["Normals"]
    return found


def _is_closed(mesh: Any) -> bool:
    """Whether triangles meet at all sides, run through once each way, around a volume above 0."""
    triangles = mesh.regular_faces
    ends = np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    turns_one_way = len(np.unique(ends, axis=0)) == len(ends)
    return mesh.n_open_edges == 0 and turns_one_way and bool(mesh.volume > 0.0)


def mesh_edges(cells: IntArray) -> IntArray:
    """The sides (e, 2) of facets (n, k), of which -1 fills short rows, each once."""
    lengths = (cells >= 0).sum(axis=1)
    found = [np.zeros((0, 2), dtype=np.int64)]
    for length, around in POINTS_AROUND_FACET.items():
        if not (lengths == length).any():
            continue
        loop = cells[lengths == length][:, around]
        found.append(np.stack([loop, np.roll(loop, -1, axis=1)], axis=-1).reshape(-1, 2))
    unique: IntArray = np.unique(np.sort(np.concatenate(found), axis=1), axis=0)
    return unique
