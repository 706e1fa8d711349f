"""The error of exports."""


class FMUError(ValueError):
    """A model that cannot become an FMU, or a machine that cannot make one."""
