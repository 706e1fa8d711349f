"""A body on several processes, by MPI and PETSc.

`start.py` starts and finds them; `build.py` is what each of them does. The rest is imported only
where mpi4py and petsc4py are installed.
"""
