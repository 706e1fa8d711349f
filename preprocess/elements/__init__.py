"""Stiffness and mass of beams and solids, and the strains in solids.

element: shape functions and points of integration of each solid; assumed: the strains of solids
that bend and keep their volume; solid, beam: matrices; strain: strains at points of a mesh;
bending: how much too stiff a mesh is; batches: elements by material; assembly_map: sums of element
matrices; inertia, beam_second, solid_second: inertia and strain energy to higher orders of motion.
"""
