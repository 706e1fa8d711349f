"""From elements, masses and interfaces to a finite element model with its rigid modes.

source: the protocol of meshes and matrices; selected: nodes and facets of a selection; interfaces,
surface: frames on them; ties: nodes that follow rigid frames; masses: lumped masses; rigid: rigid
modes and mass properties; structure: the whole model; frame_motion, second_order: frames, inertia
and strain energy of the whole model in motions that are not small.
"""
