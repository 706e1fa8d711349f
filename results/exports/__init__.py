"""Results in the formats of other programs: tables, MATLAB, VTKHDF for ParaView, and decks."""

from .loads import load_set, write_loads
from .matlab import write_mat
from .paraview import write_vtk
from .tables import write_csv

__all__ = ["load_set", "write_csv", "write_loads", "write_mat", "write_vtk"]
