"""Formats of mesh files, one in each file: `read(path) -> Draft`."""
