"""Stiffness and mass of beams and solids, and the strains in solids.

element: shape functions and points of integration of each solid; solid, beam: matrices; strain:
strains at points of a mesh; assembly_map: sums of element matrices; inertia, beam_second,
solid_second: inertia and strain energy to higher orders of motion.
"""
