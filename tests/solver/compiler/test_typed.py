"""Modules of typed functions, which serve all targets and are kept beside object files."""

import os

import pytest
from duhamel.solver.compiler import build
from duhamel.solver.compiler.targets import COMPILED_TARGETS
from duhamel.solver.compiler.typed import MAX_TYPED_MODULES
from llvmlite import binding as llvm

TEXT = "define double @twice(double %x) {{\n  %y = fmul double %x, {factor}.0\n  ret double %y\n}}"
HOST, ARM = COMPILED_TARGETS["host"], COMPILED_TARGETS["aarch64-linux"]
DUAL = COMPILED_TARGETS["derivatives-4"]
DUAL_SURFACES = COMPILED_TARGETS["derivatives-4-surfaces"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder for compiled code."""
    monkeypatch.setenv("DUHAMEL_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def typed(monkeypatch):
    """The kinds of numbers that were typed, each to a module of its own."""
    kinds = []

    def module(k, surfaces):
        kinds.append((k, surfaces))
        text = TEXT.format(factor=2 + k + 100 * surfaces)
        return llvm.parse_assembly(text).as_bitcode()

    monkeypatch.setattr(build, "_typed", module)
    return kinds


def built(*targets):
    return build.build(targets, kept=True)


def test_functions_are_typed_once_for_all_targets_and_builds(folder, typed):
    host, arm = built(HOST, ARM)
    assert typed == [(0, False)]
    assert host != arm
    assert built(ARM, HOST) == [arm, host]
    assert typed == [(0, False)]


def test_without_a_cache_they_are_typed_once_for_each_build(folder, typed):
    assert build.build([HOST, ARM]) == build.build([HOST, ARM])
    assert typed == [(0, False)] * 2
    assert not folder.exists()


def test_each_kind_of_numbers_has_a_module_of_its_own(folder, typed):
    codes = built(HOST, DUAL, DUAL_SURFACES)
    assert len(set(codes)) == 3
    assert typed == [(0, False), (4, False), (4, True)]
    assert built(DUAL_SURFACES, DUAL, HOST) == codes[::-1]
    assert len(typed) == 3


@pytest.mark.parametrize("damage", ["cut", "flipped bit", "written by others"])
def test_what_is_not_whole_or_ours_is_typed_again(folder, typed, damage):
    code = built(HOST)
    (path,) = folder.glob("typed-*.bc")
    content = path.read_bytes()
    if damage == "written by others":
        path.chmod(0o666)
    else:
        path.write_bytes(content[:-1] if damage == "cut" else bytes([content[0] ^ 1]) + content[1:])
    assert built(HOST) == code
    assert len(typed) == 2
    assert path.read_bytes() == content


def test_where_nothing_can_be_kept_it_is_built_all_the_same(tmp_path, typed, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("DUHAMEL_CACHE", str(tmp_path / "file"))
    assert built(HOST) == built(HOST)
    assert len(typed) == 2


def test_the_newest_modules_stay(folder, typed):
    folder.mkdir(mode=0o700)
    for i in range(9):
        path = folder / f"typed-{i}.bc"
        path.touch()
        os.utime(path, (i, i))
    built(HOST)
    names = {path.name for path in folder.glob("typed-*")}
    assert len(names) == MAX_TYPED_MODULES
    assert {f"typed-{i}.bc" for i in range(10 - MAX_TYPED_MODULES, 9)} < names
