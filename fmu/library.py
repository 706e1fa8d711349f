"""The shared library of an FMU: the C sources, the compiled time step and the image, linked."""

import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from ..solver.compiler.targets import own_platform
from .errors import FMUError

C_SOURCES = Path(__file__).with_name("c")
TIMING_PROGRAM = "timing.exe"


@dataclass(frozen=True)
class Platform:
    """A platform of FMI.

    zig: its target in zig's clang; name_2: its folder in FMI 2, "" if that has none; section: where
    the image stands, in the assembler's words; symbol: the image's name there; hides: what keeps
    that name from other libraries of the process, "" where names are not shared.
    """

    zig: str
    suffix: str
    name_2: str
    section: str = ".section .rodata"
    symbol: str = "duhamel_image"
    hides: str = ".hidden"


FMI_PLATFORMS = {
    "x86_64-linux": Platform("x86_64-linux-gnu.2.17", ".so", "linux64"),
    "aarch64-linux": Platform("aarch64-linux-gnu.2.17", ".so", ""),
    "x86_64-windows": Platform(
        "x86_64-windows-gnu", ".dll", "win64", '.section .rdata,\\"dr\\"', hides=""
    ),
    "aarch64-darwin": Platform(
        "aarch64-macos.11.0",
        ".dylib",
        "",
        ".section __TEXT,__const",
        "_duhamel_image",
        ".private_extern",
    ),
}
"""by their names in FMI 3"""


@dataclass(frozen=True)
class Parts:
    """What is linked for a platform.

    name: of the platform in FMI 3; identifier: of the file, without its suffix; code: the object
    file of the time step; level: of x86-64 that it needs, 0 if it is not checked.
    """

    name: str
    identifier: str
    code: bytes
    image: bytes
    level: int = 0


def linked(parts: Parts) -> bytes:
    """The library of a platform.

    `FMUError` where there is no compiler for the platform, or where it fails.
    """
    platform = FMI_PLATFORMS[parts.name]
    file = f"{parts.identifier}{platform.suffix}"
    with _laid_out(parts) as folder:
        # -s: without symbols there is nothing of this machine in it.
        options = ["-shared", "-fPIC", "-s", "-fvisibility=hidden", "fmi2.c", "fmi3.c"]
        if platform.suffix == ".dylib":
            # Without it the temporary path would be the name of the library.
            options.append(f"-Wl,-install_name,@rpath/{file}")
        return _compiled(parts.name, folder, file, options)


@dataclass(frozen=True)
class StepTimes:
    """Of so many steps, in wall time [s]: their median, the time of 99.9 % of them, the longest."""

    n: int
    median: float
    most: float
    longest: float


def step_times(parts: Parts, token: str, n: int) -> StepTimes:
    """The times of steps from the start on, with inputs as they start, on this machine."""
    with _laid_out(parts) as folder:
        _compiled(parts.name, folder, TIMING_PROGRAM, ["timing.c"])
        command = [str(folder / TIMING_PROGRAM), token, str(n)]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    if done.returncode:
        raise FMUError(f"steps cannot be taken: {done.stderr.strip() or done.returncode}")
    # The median and the tail: a mean would hide what real time is about.
    times = sorted(1e-9 * int(line) for line in done.stdout.split())
    return StepTimes(n, times[n // 2], times[int(0.999 * n) - 1], times[-1])


@contextmanager
def _laid_out(parts: Parts) -> Iterator[Path]:
    """A folder with all that is linked, for the time of a block."""
    with TemporaryDirectory(prefix="duhamel-") as place:
        folder = Path(place)
        # Relative paths alone: no folder of this machine is to be found in the library.
        for source in C_SOURCES.rglob("*.[ch]"):
            target = folder / source.relative_to(C_SOURCES)
            target.parent.mkdir(exist_ok=True)
            shutil.copyfile(source, target)
        (folder / "step.o").write_bytes(parts.code)
        (folder / "image.bin").write_bytes(parts.image)
        of_image = _image_source(FMI_PLATFORMS[parts.name], parts.level)
        (folder / "image.c").write_text(of_image, encoding="utf-8")
        yield folder


def _compiled(name: str, folder: Path, file: str, options: Sequence[str]) -> bytes:
    """What the compiler of a platform makes of all parts, as a file of this name."""
    command = [
        *compiler_of(name),
        *("-std=c11", "-O2", "-I.", "core.c", "processor.c", "image.c", "step.o"),
        *(*options, "-o", file),
        *(() if FMI_PLATFORMS[name].suffix == ".dll" else ("-lm",)),
    ]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    if done.returncode or not (folder / file).exists():
        told = done.stderr.strip().splitlines() or [f"it ended with {done.returncode}"]
        raise FMUError(f"platform {name}: the C compiler cannot link: {told[0]}")
    return (folder / file).read_bytes()


def compiler_of(name: str) -> list[str]:
    """The command of the C compiler for a platform."""
    # The same compiler for all platforms gives the same file wherever it is made.
    if find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", FMI_PLATFORMS[name].zig, "-g0"]
    local = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if name == own_platform() and local:
        return [local]
    wanted = "pip install 'duhamel[fmu]'"
    if name == own_platform():
        raise FMUError(f"platform {name}: expected a C compiler, found none: {wanted}")
    raise FMUError(
        f"platform {name}: expected ziglang, which compiles for other machines: {wanted}"
    )


def _image_source(platform: Platform, level: int) -> str:
    lines = (
        platform.section,
        f".globl {platform.symbol}",
        f"{platform.hides} {platform.symbol}" if platform.hides else "",
        ".balign 64",
        f"{platform.symbol}:",
        '.incbin \\"image.bin\\"',
        ".text",
    )
    block = "\n".join(f'"{line}\\n"' for line in lines)
    return f"const int duhamel_processor = {level};\n__asm__({block});\n"
