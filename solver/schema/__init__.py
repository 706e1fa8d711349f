"""Declarations of the fields of a model, once for Python and for model files."""
