"""Stiffness and mass from files of other programs, instead of a mesh.

matrix_files, op4: files of matrices; node_table: files of nodes; matrices: both in one order of
dofs; free_body: checks that they are those of a free elastic body.
"""
