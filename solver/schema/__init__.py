"""How the parts of a model declare their fields, once for Python and for model files."""
