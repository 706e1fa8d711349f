"""The TOML files that users write: validated tables, and errors with file, key and value."""

from .errors import InputError, dotted, quoted
from .json_schema import Also, Shown, document_of, member_of
from .names import NAME_FORM as FORM_OF_NAMES
from .names import is_name
from .table import Table, Vector, expected, read_part, read_table, rule
from .text import parse_toml, read_text, read_toml
from .writing import toml_of

__all__ = [
    "FORM_OF_NAMES",
    "Also",
    "InputError",
    "Shown",
    "Table",
    "Vector",
    "document_of",
    "dotted",
    "expected",
    "is_name",
    "member_of",
    "parse_toml",
    "quoted",
    "read_part",
    "read_table",
    "read_text",
    "read_toml",
    "rule",
    "toml_of",
]
