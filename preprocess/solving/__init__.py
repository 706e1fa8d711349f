"""Linear systems S x = b of large sparse matrices: by factors, and by conjugate gradients.

`solver.py` chooses between the two.
"""
