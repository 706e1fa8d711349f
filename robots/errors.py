"""The failure of an import."""


class RobotError(ValueError):
    """A robot that cannot be imported; the message names the file, and the link or joint."""
