"""The body file: tables that a user writes, validated, without any reference to a mesh.

selection: places on a mesh; material: materials and sections; body: the whole file.
"""
