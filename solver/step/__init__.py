"""One time step: equations, their tangent and their solution, all of it compiled to machine code."""
