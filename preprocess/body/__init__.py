"""The body file: tables that a user writes, validated, without any reference to a mesh.

selection: nodes and facets by name and by shape; material: materials and sections; body: the
whole file.
"""
