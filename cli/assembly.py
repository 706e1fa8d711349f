"""CAD files as body files, one for each solid, and a first model file with all of them."""

import os
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ..cad import CadError, Solid, solids_in
from ..files import renamed_when_whole
from ..robots.bodies import GROUND_NAME
from .assembly_files import NamedSolid, body_file, model_file, usual_size
from .assembly_pairs import pairs_of

OTHER_CHARACTERS = re.compile(r"[^A-Za-z0-9_-]+")
"""What names of files do without."""


@dataclass(frozen=True)
class ImportedAssembly:
    """What an import has written: the model file, and body files by the names of the bodies.

    joints: how many the model proposes, as comments.
    """

    path: Path
    bodies: Mapping[str, Path]
    joints: int


def import_assembly(
    source: Path, target: Path, size: float | None = None, scale: float | None = None
) -> ImportedAssembly:
    """Write a body file for each solid of a CAD file, and a model file with their positions.

    All are in the axes of the CAD file, in meters. Body files are beside the model, by the names of
    the solids; none of the files may be there already, since users change them.

    size [m]: of the elements, by default one that makes some thousand of each solid; scale [m]: the
    unit of length of a .brep file. `CadError` names the file that cannot be read or written, or is
    there already.
    """
    solids = solids_in(source, scale)
    parts, pairs = _parts(solids, source.stem, target.stem), list(pairs_of(solids))
    bodies = {part.name: target.with_name(f"{part.name}.toml") for part in parts}
    texts: dict[Path, str] = {}
    for part in parts:
        mesh: dict[str, object] = {"mesh": _relative(source, target.parent)}
        mesh |= {"solid": part.label} if len(parts) > 1 else {}
        mesh |= {} if scale is None else {"scale": scale}
        mesh["size"] = size or usual_size(part.solid)
        texts[bodies[part.name]] = body_file(part, mesh, pairs)
    texts[target] = model_file(parts, source.name, pairs)
    # Before anything is written: users change these files, and do not want them replaced.
    if found := [path for path in texts if path.exists()]:
        raise CadError(f"{found[0]}: is there already: move it, or name another folder by -o")
    _write_all(texts)
    return ImportedAssembly(target, bodies, len(pairs))


def _parts(solids: Mapping[str, Solid], file: str, model: str) -> list[NamedSolid]:
    """Solids under names that differ from one another, from that of the model and the ground."""
    # Some file systems do not tell capitals from small letters.
    taken, parts = {model.lower(), GROUND_NAME}, []
    for label, solid in solids.items():
        # Labels of single parts are often those of the program that has written the file.
        wanted = label if len(solids) > 1 else file
        plain = OTHER_CHARACTERS.sub("_", wanted).strip("_") or "part"
        name, number = plain, 2
        while name.lower() in taken:
            name, number = f"{plain}_{number}", number + 1
        taken.add(name.lower())
        parts.append(NamedSolid(name, label, solid))
    return parts


def _relative(source: Path, folder: Path) -> str:
    """The path of a file from a folder; as it is, where they are on different drives."""
    try:
        return Path(os.path.relpath(source, folder)).as_posix()
    except ValueError:
        return source.resolve().as_posix()


def _write_all(texts: Mapping[Path, str]) -> None:
    """Write all files, or leave none behind."""
    written: list[Path] = []
    try:
        for path, text in texts.items():
            with renamed_when_whole(path, failure=CadError) as temporary:
                temporary.write_text(text, encoding="utf-8")
            written.append(path)
    except BaseException:
        for path in written:
            with suppress(OSError):
                path.unlink()
        raise
