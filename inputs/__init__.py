"""The TOML files that users write: tables that are validated, and errors that name file, key and
value.
"""

from .table import InputError, Table, Vector, expected, read_part, read_table

__all__ = ["InputError", "Table", "Vector", "expected", "read_part", "read_table"]
