"""Meshes: points, cells and groups, their facets and nodes, and the files they are read from.

cells: the types of cells; mesh: points, cells and groups; numbering: numbers of nodes and elements;
nodes: the unknowns; facets: the faces of solids; connectivity: checks that a mesh is one body;
formats: a file for each format; reading: the choice of the format.
"""
