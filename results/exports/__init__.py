"""Results in the formats of other programs: comma-separated values, MATLAB, VTKHDF for ParaView."""

from .matlab import write_mat
from .paraview import write_vtk
from .steps import frames, window
from .tables import write_csv

__all__ = ["frames", "window", "write_csv", "write_mat", "write_vtk"]
