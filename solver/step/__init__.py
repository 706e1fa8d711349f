"""One time step: equations, their tangent and their solution, all of it compiled to machine code.

Whoever imports one of these modules has imported all: machine code is made of all entries at once.
"""

from . import loop as loop
from . import sizes as sizes
from . import surface_rest as surface_rest
from . import watches as watches
