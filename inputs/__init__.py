"""The TOML files that users write: validated tables, and errors with file, key and value."""

from .table import InputError, Table, Vector, expected, read_part, read_table

__all__ = ["InputError", "Table", "Vector", "expected", "read_part", "read_table"]
