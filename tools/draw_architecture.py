"""Draw docs/images/architecture.svg: packages and their rooms, and what imports what.

    python tools/draw_architecture.py

Imports are read from the sources. A room stands above all that it imports; an arrow that others
imply is left out, one against the order of `import_order` is red. The file is the same for the
same imports on any machine: tests draw it again and compare.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise
from pathlib import Path

from import_order import PACKAGES, ROOMS, ROOT, edges

DRAWING = ROOT / "docs" / "images" / "architecture.svg"
Arrow = tuple[str, str]
"""what imports, and what is imported"""

ABOUT = {
    "cli": "the command duhamel",
    "study": "many runs, from one file",
    "robots": "robots in URDF and MJCF → models",
    "fmu": "models for other programs",
    "view": "pictures of bodies, models and results",
    "results": "the motion of a run: contract of the solver with its readers",
    "cad": "CAD files → meshes, by gmsh",
    "superelement": "an elastic body as its interfaces feel it: contract of preprocess and solver",
    "inputs": "TOML tables, checked",
    "files": "files of others, opened with care; our own, written whole",
    "preprocess": "mesh → superelement",
    "solver": "model → results",
    "preprocess/errors": "one exception for each failure",
    "preprocess/threads": "threads of libraries",
    "preprocess/memory": "memory at hand",
    "preprocess/sparse": "large matrices in pieces",
    "preprocess/processes": "processes of one run",
    "preprocess/progress": "stages and their times",
    "preprocess/mesh": "points, cells, groups, file formats",
    "preprocess/body": "the body file, materials, selections",
    "preprocess/elements": "stiffness, mass and strain",
    "preprocess/given": "matrices of other programs",
    "preprocess/assembly": "interfaces, masses, rigid motions",
    "preprocess/sources": "lines, solids or matrices",
    "preprocess/solving": "linear systems: factors, cost",
    "preprocess/responses": "impulse and static responses, modes",
    "preprocess/identification": "modes from measured responses",
    "preprocess/rotation": "second order in a few coordinates",
    "preprocess/measured": "models that follow a test",
    "preprocess/derivatives": "slopes by design parameters",
    "preprocess/hammer": "simulated tests of meshes",
    "preprocess/estimate": "time and memory to expect",
    "preprocess/recovery": "fields on the surface",
    "preprocess/outline": "what a body looks like",
    "preprocess/plausibility": "doubts about units",
    "preprocess/survey": "the dry run",
    "preprocess/build": "body to superelement",
    "preprocess/verification": "statics of the mesh beside it",
    "preprocess/parallel": "the same on several processes",
    "solver/arrays": "types of arrays",
    "solver/errors": "one exception for each failure",
    "solver/compiler": "records, marks, machine code",
    "solver/schema": "fields of entries, declared once",
    "solver/laws": "force laws, compiled",
    "solver/step": "one time step, compiled",
    "solver/signals": "functions of time",
    "solver/couplings": "joints, springs, contacts, ...",
    "solver/model": "what a user says",
    "solver/history": "layout of modes and kernels",
    "solver/lower": "from names to numbers",
    "solver/checkpoint": "states that are kept",
    "solver/start": "the state at t = 0",
    "solver/output": "what is recorded",
    "solver/diagnosis": "why a step failed",
    "solver/control": "holds and stops runs",
    "solver/phases": "short and long steps",
    "solver/cosimulation": "FMUs beside the time loop",
    "solver/simulation": "all steps to t_end",
    "solver/derivatives": "runs with dual numbers",
    "solver/many": "runs on threads",
    "solver/plausibility": "doubts about models",
    "solver/trial": "the first steps of a model",
    "solver/inspection": "what a run would be",
    "solver/stepper": "the records of one step at a time",
    "solver/simulator": "one step at a time",
    "solver/linear": "modes, responses",
}
"""What a package or room holds, in a few words."""

TINTS = {
    "cli": ("#f1f3f5", "#868e96"),
    "study": ("#f1f3f5", "#868e96"),
    "robots": ("#f1f3f5", "#868e96"),
    "fmu": ("#f1f3f5", "#868e96"),
    "view": ("#f1f3f5", "#868e96"),
    "files": ("#ffe3e3", "#c2255c"),
    "inputs": ("#fff3bf", "#e8930c"),
    "superelement": ("#d3f9d8", "#2b8a3e"),
    "cad": ("#f1f3f5", "#868e96"),
    "results": ("#e5dbff", "#6741d9"),
    "preprocess": ("#fff8f0", "#d9480f"),
    "solver": ("#f0f7ff", "#1864ab"),
}
"""Fill and line of each package."""
INK, QUIET, WRONG = "#212529", "#5c636a", "#e03131"

BOX, HEIGHT = 144.0, 58.0
GAP, LEVEL = 16.0, 94.0
PASSAGE = 18.0
"""width kept for an arrow that passes a level"""
MARGIN, PAD, HEAD = 24.0, 18.0, 44.0
CHARACTERS = 21
"""of a line of text in a box"""


@dataclass
class Box:
    """A rectangle with a name; a room or a package."""

    name: str
    x: float
    y: float
    w: float
    h: float

    @property
    def bottom(self) -> float:
        return self.y + self.h

    @property
    def right(self) -> float:
        return self.x + self.w

    @property
    def middle(self) -> float:
        return self.x + 0.5 * self.w


@dataclass
class Layers:
    """The rooms of a package from the bottom up; "" in `passing` are arrows that pass a level."""

    arrows: list[Arrow]
    levels: list[list[str]]
    paths: dict[Arrow, list[str]] = field(default_factory=dict)
    """of each arrow what it meets, from the importing room down"""

    def width_of(self, name: str) -> float:
        return PASSAGE if "|" in name else BOX

    def width(self) -> float:
        return max(sum(map(self.width_of, level)) + GAP * (len(level) - 1) for level in self.levels)


def reduced(arrows: Iterable[Arrow]) -> list[Arrow]:
    """The arrows that no chain of others implies."""
    found = sorted(set(arrows))

    def implied(arrow: Arrow) -> bool:
        seen, waiting = {arrow[0]}, [arrow[0]]
        while waiting:
            start = waiting.pop()
            ends = {b for a, b in found if a == start and (a, b) != arrow} - seen
            seen |= ends
            waiting += ends
        return arrow[1] in seen

    return [arrow for arrow in found if not implied(arrow)]


def room_arrows(package: str) -> list[Arrow]:
    """Which room of a package imports which, as "solver/step"."""
    found = {
        (f"{package}/{module[1]}", f"{package}/{target[1]}")
        for module, target in edges(package)
        if target[0] == package
    }
    return sorted((a, b) for a, b in found if a != b and "__" not in f"{a} {b}")


def package_arrows() -> list[Arrow]:
    """Which package imports which."""
    found = {(package, target[0]) for package in PACKAGES for _, target in edges(package)}
    return sorted((a, b) for a, b in found if a != b)


def marks(package: str) -> dict[str, list[str]]:
    """The packages that each room imports."""
    found: dict[str, set[str]] = {}
    for module, target in edges(package):
        if target[0] != package:
            found.setdefault(f"{package}/{module[1]}", set()).add(target[0])
    return {room: [name for name in PACKAGES if name in names] for room, names in found.items()}


def layers(package: str) -> Layers:
    """Each room one level above the highest that it imports; sinks as high as their users allow."""
    rooms = [f"{package}/{room}" for room in ROOMS[package] if "__" not in room]
    number = {room: i for i, room in enumerate(rooms)}
    arrows = [(a, b) for a, b in reduced(room_arrows(package)) if number[b] < number[a]]
    level = dict.fromkeys(rooms, 0)
    for room in rooms:
        level[room] = max((level[b] + 1 for a, b in arrows if a == room), default=0)
    for room in reversed(rooms):
        above = [level[a] - 1 for a, b in arrows if b == room]
        below = [b for a, b in arrows if a == room]
        if above and len(above) > len(below):
            level[room] = max(level[room], min(above))
    levels: list[list[str]] = [[] for _ in range(1 + max(level.values()))]
    for room in rooms:
        levels[level[room]].append(room)
    made = Layers(arrows, levels)
    for a, b in arrows:
        passed = [f"{a}|{b}|{k}" for k in range(level[a] - 1, level[b], -1)]
        for k, name in zip(range(level[a] - 1, level[b], -1), passed, strict=True):
            levels[k].append(name)
        made.paths[a, b] = [a, *passed, b]
    _order(made)
    return made


def _order(made: Layers) -> None:
    """Sort every level by where its neighbors stand, up and down, until fewest arrows cross."""
    links = [pair for path in made.paths.values() for pair in pairwise(path)]
    best, fewest = [list(level) for level in made.levels], _crossings(made.levels, links)
    for turn in range(24):
        order = range(len(made.levels)) if turn % 2 else range(len(made.levels) - 1, -1, -1)
        for k in order:
            near = made.levels[k - 1 if turn % 2 else k + 1] if _inside(made, k, turn) else []
            place = {name: i / max(1, len(near) - 1) for i, name in enumerate(near)}
            own = {
                name: i / max(1, len(made.levels[k]) - 1) for i, name in enumerate(made.levels[k])
            }

            def mean(
                name: str, place: dict[str, float] = place, own: dict[str, float] = own
            ) -> float:
                found = [place[b] for a, b in links if a == name and b in place]
                found += [place[a] for a, b in links if b == name and a in place]
                return sum(found) / len(found) if found else own[name]

            made.levels[k].sort(key=mean)
        if (crossing := _crossings(made.levels, links)) < fewest:
            best, fewest = [list(level) for level in made.levels], crossing
    made.levels[:] = best
    _shorten(made, links)


def _shorten(made: Layers, links: Sequence[Arrow]) -> None:
    """Swap neighbors of a level while arrows get shorter and no more of them cross."""
    frame = Box("", 0.0, 0.0, made.width() + 2 * PAD, 0.0)

    def cost() -> tuple[int, float]:
        boxes = place_rooms(made, frame, LEVEL)
        length = sum(abs(boxes[a].middle - boxes[b].middle) for a, b in links)
        return _crossings(made.levels, links), round(length, 3)

    least, shorter = cost(), True
    while shorter:
        shorter = False
        for level in made.levels:
            for i in range(len(level) - 1):
                level[i], level[i + 1] = level[i + 1], level[i]
                if (found := cost()) < least:
                    least, shorter = found, True
                else:
                    level[i], level[i + 1] = level[i + 1], level[i]


def _inside(made: Layers, k: int, turn: int) -> bool:
    return k > 0 if turn % 2 else k + 1 < len(made.levels)


def _crossings(levels: Sequence[Sequence[str]], links: Sequence[Arrow]) -> int:
    count = 0
    for lower, upper in pairwise(levels):
        ends = [(upper.index(a), lower.index(b)) for a, b in links if a in upper and b in lower]
        count += sum(a < c and b > d for a, b in ends for c, d in ends)
    return count


def place_rooms(made: Layers, frame: Box, rise: float) -> dict[str, Box]:
    """Boxes of rooms and passages, each as near as it can be to what it is joined with.

    rise: from one level to the next.
    """
    links = [pair for path in made.paths.values() for pair in pairwise(path)]
    boxes: dict[str, Box] = {}
    for k, level in enumerate(made.levels):
        y = frame.bottom - PAD - HEIGHT - k * rise
        free = frame.w - 2 * PAD - sum(map(made.width_of, level)) - GAP * (len(level) - 1)
        x = frame.x + PAD + 0.5 * free
        for name in level:
            boxes[name] = Box(name, x, y, made.width_of(name), HEIGHT)
            x += boxes[name].w + GAP
    for turn in range(40):
        for level in made.levels if turn % 2 else reversed(made.levels):
            wanted = {}
            for name in level:
                near = [boxes[b].middle for a, b in links if a == name]
                near += [boxes[a].middle for a, b in links if b == name]
                middle = sum(near) / len(near) if near else boxes[name].middle
                wanted[name] = middle - 0.5 * boxes[name].w
            _spread([boxes[name] for name in level], wanted, frame)
    return boxes


def _spread(boxes: Sequence[Box], wanted: dict[str, float], frame: Box) -> None:
    """Move the boxes of a level towards where they are wanted, apart from one another."""
    for box in boxes:
        box.x += 0.5 * (wanted[box.name] - box.x)
    for left, right in pairwise(boxes):
        right.x = max(right.x, left.right + GAP)
    limit = frame.right - PAD
    for box in reversed(boxes):
        box.x = min(box.x, limit - box.w)
        limit = box.x - GAP
    start = frame.x + PAD
    for box in boxes:
        box.x = max(box.x, start)
        start = box.right + GAP


def drawing() -> str:
    """The picture as the text of an SVG file."""
    inner = {package: layers(package) for package in ("preprocess", "solver")}
    frames = _frames(inner)
    width = max(frame.right for frame in frames.values()) + MARGIN
    height = max(frame.bottom for frame in frames.values()) + 62.0
    parts = [_head(width, height)]
    for package, frame in frames.items():
        parts.append(_frame(package, frame, title=package in inner))
    order = list(PACKAGES)
    for a, b in reduced(package_arrows()):
        wrong = order.index(b) > order.index(a)
        parts.append(_between(frames[a], frames[b], wrong))
    for package, made in inner.items():
        parts += _inside_of(package, made, frames[package])
    parts.append(_legend(frames["files"].bottom + 34.0))
    return "\n".join([*parts, "</svg>", ""])


def _frames(inner: dict[str, Layers]) -> dict[str, Box]:
    """Users of both walks on top, the walks side by side, the contracts beside and below them."""
    widths = {package: made.width() + 2 * PAD for package, made in inner.items()}
    heights = {
        package: HEAD + PAD + HEIGHT + LEVEL * (len(made.levels) - 1)
        for package, made in inner.items()
    }
    walk, top, space, side = max(heights.values()), 54.0, 40.0, 150.0
    x_solver = MARGIN + widths["preprocess"] + space
    x_side = x_solver + widths["solver"] + space
    right = x_side + side
    # Study uses both walks; robots and fmu use the solver alone, and share the place above it.
    half = 0.5 * (widths["solver"] - space)
    y_study = MARGIN + top + space
    y_walk = y_study + top + space
    y_inputs = y_walk + walk + space
    y_superelement = y_inputs + top + space
    y_files = y_superelement + top + space
    full = right - MARGIN
    return {
        "cli": Box("cli", MARGIN, MARGIN, full, top),
        "study": Box("study", MARGIN, y_study, widths["preprocess"], top),
        "robots": Box("robots", x_solver, y_study, half, top),
        "fmu": Box("fmu", x_solver + half + space, y_study, half, top),
        "preprocess": Box("preprocess", MARGIN, y_walk, widths["preprocess"], walk),
        "solver": Box("solver", x_solver, y_walk, widths["solver"], walk),
        "view": Box("view", x_side, y_walk, side, 96.0),
        "results": Box("results", x_side, y_walk + 0.5 * walk - 56.0, side, 112.0),
        "inputs": Box("inputs", x_solver - 180.0, y_inputs, 320.0, top),
        "cad": Box("cad", MARGIN, y_inputs, 260.0, top),
        "superelement": Box("superelement", MARGIN, y_superelement, full - 180.0, top),
        "files": Box("files", MARGIN, y_files, full, top),
    }


def _head(width: float, height: float) -> str:
    markers = "".join(
        f'<marker id="{name}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" '
        f'markerHeight="8" markerUnits="userSpaceOnUse" orient="auto">'
        f'<path d="M0 1 L10 5 L0 9 z" fill="{color}"/></marker>'
        for name, color in (("arrow", QUIET), ("wrong", WRONG))
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
        f'width="{width:.0f}" height="{height:.0f}" '
        f'font-family="Helvetica, Arial, DejaVu Sans, sans-serif">\n'
        f"<title>Packages and rooms of Duhamel, and what imports what</title>\n"
        f"<defs>{markers}</defs>\n"
        f'<rect width="100%" height="100%" fill="#ffffff"/>'
    )


def _frame(package: str, frame: Box, title: bool) -> str:
    fill, line = TINTS[package]
    rect = _rect(frame, fill, line, 10)
    if title:
        name = _text(frame.x + PAD, frame.y + 29, package, 19, line, weight="bold", anchor="start")
        about = _text(
            frame.x + PAD + 16 + 11.5 * len(package),
            frame.y + 29,
            ABOUT[package],
            14,
            QUIET,
            anchor="start",
        )
        return "\n".join([rect, name, about])
    return "\n".join([rect, *_labels(package, frame, 17, 13, line)])


def _inside_of(package: str, made: Layers, frame: Box) -> list[str]:
    rise = (frame.h - HEAD - PAD - HEIGHT) / (len(made.levels) - 1)
    boxes = place_rooms(made, frame, rise)
    parts = []
    starts = _ports(made, boxes, upper=True)
    ends = _ports(made, boxes, upper=False)
    for arrow, path in made.paths.items():
        middle = [boxes[name] for name in path[1:-1]]
        first, last = boxes[path[0]], boxes[path[-1]]
        points = [(starts[arrow], first.bottom)]
        for box in middle:
            points += [(box.middle, box.y), (box.middle, box.bottom)]
        points.append((ends[arrow], last.y - 1))
        parts.append(_curve(points))
    _, line = TINTS[package]
    imported = marks(package)
    for name, box in boxes.items():
        if "|" in name:
            continue
        parts.append(_rect(box, "#ffffff", line, 6))
        parts += _labels(name, box, 15, 11.5, INK)
        for i, other in enumerate(imported.get(name, [])):
            x = box.right - 11 - 13 * i
            parts.append(_mark(x, box.y + 11, other))
    numbers = {f"{package}/{room}": i for i, room in enumerate(ROOMS[package])}
    for a, b in reduced(room_arrows(package)):
        if numbers[b] > numbers[a]:
            parts.append(
                _curve([(boxes[a].middle, boxes[a].y), (boxes[b].middle, boxes[b].bottom)], True)
            )
    return parts


def _ports(made: Layers, boxes: dict[str, Box], upper: bool) -> dict[Arrow, float]:
    """Where arrows leave the rooms that import, or reach those that are imported, side by side."""
    ports: dict[Arrow, float] = {}
    at: dict[str, list[Arrow]] = {}
    for arrow in made.paths:
        at.setdefault(arrow[0] if upper else arrow[1], []).append(arrow)
    for room, own in at.items():
        next_to = {arrow: made.paths[arrow][1 if upper else -2] for arrow in own}
        own.sort(key=lambda arrow: boxes[next_to[arrow]].middle)
        step = min(26.0, 0.7 * boxes[room].w / len(own))
        for i, arrow in enumerate(own):
            ports[arrow] = boxes[room].middle + step * (i - 0.5 * (len(own) - 1))
    return ports


def _between(a: Box, b: Box, wrong: bool) -> str:
    """An arrow from package to package: straight down or up, or straight across."""
    left, right = max(a.x, b.x), min(a.right, b.right)
    if right - left > 20.0:
        x = 0.5 * (left + right) + (14.0 if wrong else 0.0)
        ends = [(x, a.bottom), (x, b.y - 1)] if a.y < b.y else [(x, a.y), (x, b.bottom + 1)]
    else:
        y = 0.5 * (max(a.y, b.y) + min(a.bottom, b.bottom)) + (14.0 if wrong else 0.0)
        ends = [(a.right, y), (b.x - 1, y)] if a.x < b.x else [(a.x, y), (b.right + 1, y)]
    return _curve(ends, wrong, 1.8)


def _labels(name: str, box: Box, size: float, small: float, color: str) -> list[str]:
    """The name of a room or package and what it holds, in the middle of its box."""
    characters = int(CHARACTERS * (box.w / BOX) * 11.5 / small)
    lines = _wrapped(ABOUT.get(name, ""), characters)
    step = small + 2.5
    y = box.y + 0.5 * (box.h - size - step * len(lines)) + 0.82 * size
    parts = [_text(box.middle, y, name.rpartition("/")[2], size, color, weight="bold")]
    for i, line in enumerate(lines):
        parts.append(_text(box.middle, y + 3 + step * (i + 0.85), line, small, QUIET))
    return parts


def _wrapped(text: str, characters: int) -> list[str]:
    lines: list[str] = []
    for word in text.split():
        if lines and len(lines[-1]) + 1 + len(word) <= characters:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


def _legend(y: float) -> str:
    parts, x = [], MARGIN + 6.0
    for package in ("files", "inputs", "superelement", "results"):
        parts.append(_mark(x, y - 4, package))
        parts.append(_text(x + 11, y, f"imports {package}", 13, QUIET, anchor="start"))
        x += 48.0 + 7.4 * len(f"imports {package}")
    parts.append(_curve([(x, y - 5), (x + 34, y - 5)]))
    text = "imports; what a chain of arrows implies is left out. Each stands above what it imports."
    parts.append(_text(x + 44, y, text, 13, QUIET, anchor="start"))
    return "\n".join(parts)


def _mark(x: float, y: float, package: str) -> str:
    _, line = TINTS[package]
    return (
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{line}">'
        f"<title>imports {package}</title></circle>"
    )


def _rect(box: Box, fill: str, line: str, radius: float) -> str:
    return (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.w:.1f}" height="{box.h:.1f}" '
        f'rx="{radius:.0f}" fill="{fill}" stroke="{line}" stroke-width="1.4"/>'
    )


def _text(
    x: float,
    y: float,
    text: str,
    size: float,
    color: str,
    weight: str = "normal",
    anchor: str = "middle",
) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" font-weight="{weight}" '
        f'fill="{color}" text-anchor="{anchor}">{escape(text)}</text>'
    )


def _curve(points: Sequence[tuple[float, float]], wrong: bool = False, width: float = 1.3) -> str:
    """A smooth line through points, which leaves and arrives upright (across, if it is level)."""
    (x, y), *others = points
    path = f"M{x:.1f} {y:.1f}"
    for to_x, to_y in others:
        if abs(to_y - y) < 1.0:
            path += f" L{to_x:.1f} {to_y:.1f}"
        else:
            half = 0.5 * (y + to_y)
            path += f" C{x:.1f} {half:.1f} {to_x:.1f} {half:.1f} {to_x:.1f} {to_y:.1f}"
        x, y = to_x, to_y
    color, marker = (WRONG, "wrong") if wrong else (QUIET, "arrow")
    return (
        f'<path d="{path}" fill="none" stroke="{color}" stroke-width="{width}" '
        f'marker-end="url(#{marker})"/>'
    )


def main(path: Path = DRAWING) -> None:
    path.write_text(drawing(), encoding="utf-8")


if __name__ == "__main__":
    main()
