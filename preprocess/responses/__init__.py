"""Impulse and static responses of the interfaces, from the matrices of a structure.

impulse: the choice of the method, one of modal, krylov (on a basis, to the error of a band) and
march; static: compliance and initial accelerations; damping; factor: sparse factorizations; cost:
their memory and time.
"""
