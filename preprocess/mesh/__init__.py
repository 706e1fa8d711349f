"""Meshes: what they are, their facets and nodes, and the file formats that they are read from."""
