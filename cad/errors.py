"""The error of CAD files."""


class CadError(ValueError):
    """A CAD file that cannot be read or meshed, or a hole or face that it does not have."""
