"""The sources of a body, one in each file, and the choice of the one that a body file names.

lines: a mesh of lines with sections; solids: a mesh of solids with materials; given: matrices of
another program; assignment: sections and materials by groups; solid_surface: points of the surface
of solids; reading: the choice.
"""
