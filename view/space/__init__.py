"""Pictures in space: films of runs, and single frames of them."""

from .film import Film, animate

__all__ = ["Film", "animate"]
