"""What all body files have: a name, and the text that a superelement keeps of them."""

from typing import Any

from pydantic import PrivateAttr

from ...inputs import Table, quoted, rule
from ...inputs.names import MAX_NAME_LENGTH


class NamedBody(Table):
    """A body by its file: `Body` is that of a mesh or matrices, `MeasuredBody` that of a test.

    name: that of the file, unless given; in Python it must be.
    """

    name: str = ""
    _text: str = PrivateAttr(default="")
    _as_read: dict[str, Any] = PrivateAttr(default_factory=dict)

    @rule
    def _own_name(self) -> None:
        if not (0 < len(self.name) <= MAX_NAME_LENGTH and self.name.isprintable()):
            raise ValueError(
                f"name: expected 1 to {MAX_NAME_LENGTH} characters, found {quoted(self.name)}"
            )

    @property
    def text(self) -> str:
        """The body file as read; of a body made or changed in Python, its values in JSON."""
        # Comments of the user are kept only while they describe the body that was built.
        unchanged = self._text and self._as_read == self._values()
        return self._text if unchanged else self.model_dump_json(exclude_unset=True)

    def keep(self, text: str) -> None:
        """Keep the text that it was read from."""
        self._text, self._as_read = text, self._values()

    def _values(self) -> dict[str, Any]:
        """All but the paths, which depend on the folder that the file is read from."""
        raise NotImplementedError
