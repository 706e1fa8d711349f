"""Pictures that are saved, and that notebooks show."""

import base64
import io
import os
from pathlib import Path

from duhamel import view
from matplotlib.figure import Figure


class Picture:
    """A picture, which notebooks show: `picture.save("bar.png")`."""

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        """the figure of matplotlib, to change what one likes"""

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write it in the format of the suffix: .png, .pdf, .svg; `PictureError` if it cannot."""
        view.save(self.figure, path)
        return Path(path)

    def _repr_png_(self) -> bytes:
        image = io.BytesIO()
        self.figure.savefig(image, format="png", dpi=100)
        return image.getvalue()


def embedded(png: bytes) -> str:
    """A picture within a page of HTML."""
    return f'<img src="data:image/png;base64,{base64.b64encode(png).decode()}" width="640">'
