"""Results in the formats of other programs: comma-separated values, MATLAB, VTKHDF for ParaView."""

from .matlab import write_mat
from .paraview import write_vtk
from .tables import write_csv

__all__ = ["write_csv", "write_mat", "write_vtk"]
