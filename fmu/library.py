"""The shared library of an FMU: the C sources, the compiled time step and the image, linked."""

import shutil
import subprocess
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from .errors import ExportError

SOURCES = Path(__file__).with_name("c")


@dataclass(frozen=True)
class Platform:
    """A platform of FMI.

    zig: its target in zig's clang; name_2: its folder in FMI 2, "" if that has none; section: where
    the image stands, in the assembler's words; symbol: the image's name there.
    """

    zig: str
    suffix: str
    name_2: str
    section: str = ".section .rodata"
    symbol: str = "duhamel_image"


PLATFORMS = {
    "x86_64-linux": Platform("x86_64-linux-gnu.2.17", ".so", "linux64"),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", ".so", ""),
    "x86_64-windows": Platform("x86_64-windows-gnu", ".dll", "win64", '.section .rdata,\\"dr\\"'),
    "aarch64-darwin": Platform(
        "aarch64-macos.11.0", ".dylib", "", ".section __TEXT,__const", "_duhamel_image"
    ),
}
"""by their names in FMI 3"""


def own_platform() -> str:
    """The platform of this machine."""
    import platform

    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(
        platform.machine().lower(), platform.machine().lower()
    )
    return f"{machine}-{platform.system().lower()}"


def linked(name: str, identifier: str, code: bytes, image: bytes, level: int) -> bytes:
    """The library of a platform, by its name in FMI 3.

    identifier: the name of the file without its suffix; code: the object file of the time step;
    level: of x86-64 that it needs, 0 if it is not checked.
    `ExportError` where there is no compiler for the platform, or where it fails.
    """
    platform = PLATFORMS[name]
    with TemporaryDirectory(prefix="duhamel-") as place:
        folder = Path(place)
        # Relative paths alone: no folder of this machine is to be found in the library.
        for source in SOURCES.rglob("*.[ch]"):
            target = folder / source.relative_to(SOURCES)
            target.parent.mkdir(exist_ok=True)
            shutil.copyfile(source, target)
        (folder / "step.o").write_bytes(code)
        (folder / "image.bin").write_bytes(image)
        (folder / "image.c").write_text(_image_source(platform, level), encoding="utf-8")
        library = folder / f"{identifier}{platform.suffix}"
        command = [
            *compiler_of(name),
            *("-shared", "-std=c11", "-O2", "-fPIC", "-s", "-fvisibility=hidden", "-I."),
            *("core.c", "fmi2.c", "fmi3.c", "processor.c", "image.c", "step.o", "-o", library.name),
        ]
        if platform.suffix == ".dylib":
            # Without it the temporary path would be the name of the library.
            command.append(f"-Wl,-install_name,@rpath/{library.name}")
        if platform.suffix != ".dll":
            command.append("-lm")
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
        if done.returncode or not library.exists():
            told = done.stderr.strip().splitlines() or [f"it ended with {done.returncode}"]
            raise ExportError(f"platform {name}: {command[0]} cannot link: {told[0]}")
        return library.read_bytes()


def compiler_of(name: str) -> list[str]:
    """The command of the C compiler for a platform."""
    if find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[name].zig, "-g0"]
    local = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if name == own_platform() and local:
        return [local]
    wanted = "pip install 'duhamel[fmu]'"
    if name == own_platform():
        raise ExportError(f"platform {name}: expected a C compiler, found none: {wanted}")
    raise ExportError(
        f"platform {name}: expected ziglang, which compiles for other machines: {wanted}"
    )


def _image_source(platform: Platform, level: int) -> str:
    lines = (
        platform.section,
        f".globl {platform.symbol}",
        ".balign 64",
        f"{platform.symbol}:",
        '.incbin \\"image.bin\\"',
        ".text",
    )
    block = "\n".join(f'"{line}\\n"' for line in lines)
    return f"const int duhamel_processor = {level};\n__asm__({block});\n"
