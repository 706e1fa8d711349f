"""Stiffness and mass from files of other programs, instead of a mesh.

matrix_files: files of matrices, by market, op4, op2, dmig, user_element and ansys_full;
matrix_names: which of several; node_table: files of nodes; matrices: both in one order of dofs;
free_body: checks that they are those of a free elastic body.
"""
