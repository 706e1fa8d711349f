"""From elements, masses and interfaces to a finite element model with its rigid modes.

interfaces, surface: frames on nodes and facets; ties: nodes that follow rigid frames; masses:
lumped masses; rigid: rigid modes and mass properties; structure: the whole model.
"""
