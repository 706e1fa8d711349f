"""The saved state of a `Simulator`, to which it can go back."""

import os
from pathlib import Path

from ...files.outputs import in_words
from ..errors import ResultsError
from ..lower.lower import LoweredModel
from .carried import Snapshot
from .file import StateFile, read_state
from .identity import Identity, identity_of


class SavedState:
    """The state of a `Simulator` after a step, as `Simulator.save` gives it.

    It is a copy that no later step changes. `Simulator.restore` takes it any number of times, also
    that of another `Simulator` of the same model. See `Simulator` for an example.
    """

    def __init__(
        self, snapshot: Snapshot, lowered: LoweredModel | None, identity: Identity | None = None
    ) -> None:
        self._snapshot, self._lowered, self._identity = snapshot, lowered, identity

    @property
    def snapshot(self) -> Snapshot:
        return self._snapshot

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the state to a file, whole or not at all; `ResultsError` if it cannot be."""
        file = StateFile(self._snapshot, self.identity)
        try:
            file.write(Path(path))
        except OSError as error:
            raise ResultsError(f"{path}: cannot be written: {in_words(error)}") from error

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> "SavedState":
        """The state in a file; `StateError` for a file that is none, or damaged."""
        file = read_state(Path(path))
        return cls(file.snapshot, None, file.identity)

    @property
    def identity(self) -> Identity:
        if self._identity is None:
            assert self._lowered is not None
            self._identity = identity_of(self._lowered)
        return self._identity

    def check(self, lowered: LoweredModel) -> None:
        """`StateError` unless the state is one of this model."""
        if self._lowered is not lowered:
            self.identity.check_model(lowered.model)
            self.identity.check_steps(lowered)
            self.identity.check_system(lowered)


Moment = SavedState
"""the former name of `SavedState`"""
