"""Parts of files in the how-to guides are parts of files that are read; their programs run.

A guide shows what it is about alone: here that is added to files that have the rest. Guides with
whole files, which are walked through, have tests of their own.
"""

import tomllib
from pathlib import Path
from typing import Any

import pytest
import tomli_w
from duhamel import preprocess, solver, study
from duhamel.results import Results
from import_order import ROOT

from .walk import Block, blocks, walk

WALKED = "how-to/drop-test.md"
"""the guide that shows whole files and commands"""
OWN_WALKS = (
    *("how-to/robot-arm.md", "how-to/hammer-test.md", "how-to/robots.md"),
    *("how-to/controller-fmu.md", "how-to/cad.md"),
)

ALL = sorted(f"how-to/{path.name}" for path in (ROOT / "docs" / "how-to").glob("*.md"))
GUIDES = [guide for guide in ALL if guide not in (WALKED, *OWN_WALKS)]
BASES = {
    "body.toml": """
        name = "part"
        mesh = "part.msh"
        [material]
        E = 2.1e11
        nu = 0.3
        rho = 7850
        [interfaces.root]
        group = "root"
        [impulse]
        step = 1e-4
        steps = 100
    """,
    "model.toml": """
        [simulation]
        t_end = 0.1
        step = 1e-3
        rho_inf = 0.9
        [ground.frames]
        wall = {position = [0, 0, -0.5]}
        [bodies.arm]
        mass = 1.0
        inertia = [0.1, 0.1, 0.1]
        frames.tip = {position = [0.2, 0, 0]}
        [bodies.table]
        mass = 1.0
        inertia = [0.1, 0.1, 0.1]
        [[joints]]
        name = "pivot"
        type = "revolute"
        between = ["ground", "arm"]
        axis = [0, 1, 0]
        [[springs]]
        name = "mount"
        type = "point"
        between = ["ground.wall", "arm.tip"]
        stiffness = 1e3
    """,
}
FRAGMENTS = [
    pytest.param(block, id=f"{guide}-{number}")
    for guide in GUIDES
    for number, block in enumerate(blocks(guide))
    if block.kind == "toml"
]
PROGRAMS = [
    pytest.param(block.text, id=guide)
    for guide in GUIDES
    for block in blocks(guide)
    if block.kind == "python"
]


def merged(base: dict[str, Any], part: dict[str, Any]) -> dict[str, Any]:
    """A base with a part: tables key by key, arrays of tables one after the other."""
    whole = dict(base)
    for key, value in part.items():
        if isinstance(value, dict):
            whole[key] = merged(base.get(key, {}), value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            whole[key] = [*base.get(key, []), *value]
        else:
            whole[key] = value
    return whole


@pytest.mark.parametrize("block", FRAGMENTS)
def test_what_a_guide_shows_is_read(block: Block, tmp_path: Path) -> None:
    assert block.title is not None
    base = tomllib.loads(BASES.get(block.title, ""))
    path = tmp_path / block.title
    path.write_text(tomli_w.dumps(merged(base, tomllib.loads(block.text))), encoding="utf-8")
    if block.title in ("body.toml", "tested.toml"):
        preprocess.read_body(path)
    elif block.title == "model.toml":
        solver.read_model(path)
    else:
        (tmp_path / "model.toml").write_text(BASES["model.toml"], encoding="utf-8")
        assert len(study.read_study(path).cases) == 6


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_program_of_a_guide_runs(program: str) -> None:
    exec(compile(program, "guide", "exec"), {})


def test_the_drop_test_goes_as_it_is_written_and_the_floor_takes_all_momentum(
    tmp_path: Path,
) -> None:
    """The impulses of all feet are m (v + v') + m g t of the box, 0.2592 + 0.0432 kg, and pads."""
    assert walk(WALKED, tmp_path) == []
    results = Results.read(tmp_path / "drop-results.h5")
    floor = sum(float(results.contact(name).impulse[-1]) for name in results.contacts)
    mass, time = 2700.0 * (0.2 * 0.12 * 0.004 + 4 * 0.02**2 * 0.01) + 4 * 0.005, results.time[-1]
    before, after = -mass * (2 * 9.81 * 0.1) ** 0.5, results.momentum.linear[-1, 2]
    assert floor == pytest.approx(after - before + mass * 9.81 * time, rel=1e-6)
    for name, contact in ((name, results.contact(name)) for name in results.contacts):
        assert contact.impulse[-1] == pytest.approx(contact.events.impulse.sum(), rel=1e-12), name
