"""Where machine code is kept, and what happens where it cannot be kept, found, trusted or made."""

import os
import resource
import stat
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from pkgutil import iter_modules
from types import SimpleNamespace

import pytest
from duhamel.solver.compiler import cache as cache_module
from duhamel.solver.compiler import digests, marks, object_file
from duhamel.solver.step import newton, records, system
from duhamel.solver.step.elimination import factorize

CODE = bytes(range(256)) * 10
FOLDER = Path(__file__).parent


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty folder for compiled code."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("DUHAMEL_CACHE", str(folder))
    return folder


@pytest.fixture
def made(monkeypatch):
    """How often code was built: it is not, but for a count."""
    count = []
    monkeypatch.setattr(object_file, "_built_codes", lambda _: count.append(1) or [CODE])
    return count


@pytest.fixture(scope="session")
def compiled():
    """The object file of this session."""
    with pytest.raises(TypeError):
        factorize(None)
    return kept_file()


def kept_file():
    return cache_module.cache_folder() / object_file._name()


def run(code, **environment):
    """Standard output and error of a Python process."""
    return subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )


def test_code_is_built_once_and_found_again(cache, made):
    assert object_file._cached_code() is None
    assert object_file._new_code() == CODE
    assert object_file._new_code() == CODE
    assert object_file._cached_code() == CODE
    assert len(made) == 1


def test_only_the_user_may_read_and_write_it(cache, made):
    object_file._new_code()
    assert stat.S_IMODE(cache.stat().st_mode) == 0o700
    assert stat.S_IMODE(kept_file().stat().st_mode) == 0o600


@pytest.mark.parametrize("damage", ["truncated", "empty", "flipped bit", "no digest"])
def test_a_damaged_file_is_built_again(cache, made, damage):
    object_file._new_code()
    path = kept_file()
    content = path.read_bytes()
    path.write_bytes(
        {
            "truncated": content[:-1],
            "empty": b"",
            "flipped bit": bytes([content[0] ^ 1]) + content[1:],
            "no digest": CODE,
        }[damage]
    )
    assert object_file._cached_code() is None
    assert object_file._new_code() == CODE
    assert len(made) == 2
    assert path.read_bytes() == content


@pytest.mark.parametrize("mode", [0o620, 0o602, 0o666])
def test_a_file_that_others_may_write_is_not_loaded(cache, made, mode, capsys):
    object_file._new_code()
    kept_file().chmod(mode)
    assert object_file._cached_code() is None
    assert "is not used: another user owns it or may write to it" in capsys.readouterr().err
    object_file._new_code()
    assert stat.S_IMODE(kept_file().stat().st_mode) == 0o600


def test_a_file_of_another_user_is_not_loaded():
    def is_private(uid):
        return cache_module.is_private(SimpleNamespace(st_uid=uid, st_mode=0o100600))

    assert is_private(os.geteuid())
    assert is_private(0)
    assert not is_private(os.geteuid() + 1)


@pytest.mark.parametrize("kind", ["link", "pipe", "folder"])
def test_only_a_regular_file_is_loaded(cache, made, tmp_path, kind):
    """A link may lead to a file of the user, as to a download, that somebody else has made."""
    object_file._new_code()
    path, content = kept_file(), kept_file().read_bytes()
    path.unlink()
    if kind == "link":
        (tmp_path / "download").write_bytes(content)
        path.symlink_to(tmp_path / "download")
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.mkdir()
    assert object_file._cached_code() is None


def test_a_link_named_lock_empties_no_file(cache, made, tmp_path):
    diary = tmp_path / "diary.txt"
    diary.write_text("precious")
    cache.mkdir(mode=0o700)
    (cache / "lock").symlink_to(diary)
    assert object_file._new_code() == CODE
    assert diary.read_text() == "precious"


@pytest.fixture
def home(monkeypatch, tmp_path):
    """The user's own folder of caches, which is not yet there."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home"))
    return tmp_path / "home" / "duhamel"


@pytest.mark.parametrize("mode", [0o777, 0o1777, 0o770, 0o702])
def test_a_folder_that_others_may_write_to_is_neither_read_nor_written(
    cache, home, made, capsys, mode
):
    object_file._new_code()
    before = {path.name: path.stat().st_mtime_ns for path in cache.iterdir()}
    cache.chmod(mode)
    assert object_file._cached_code() is None
    assert f"folder {cache} is not used" in (message := capsys.readouterr().err)
    assert f"{home} is tried instead" in message
    assert object_file._new_code() == CODE
    assert kept_file().parent == home
    assert {path.name: path.stat().st_mtime_ns for path in cache.iterdir()} == before


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives folders away")
@pytest.mark.parametrize("given_away", ["folder", "link to it"])
def test_a_folder_of_another_user_is_not_used(cache, home, made, given_away):
    object_file._new_code()
    if given_away == "folder":
        os.chown(cache, 65534, 65534)
    else:
        cache.rename(home.parent.parent / "moved")
        cache.symlink_to(home.parent.parent / "moved")
        os.chown(cache, 65534, 65534, follow_symlinks=False)
    assert object_file._cached_code() is None
    assert kept_file().parent == home


def test_where_no_folder_is_private_code_is_used_and_not_kept(
    cache, home, made, monkeypatch, tmp_path, capsys
):
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(tmp_path))
    places = [cache, home, tmp_path / f"duhamel-{os.geteuid()}"]
    for place in places:
        place.mkdir(parents=True)
        place.chmod(0o777)
    assert object_file._cached_code() is None
    assert object_file._new_code() == CODE
    assert "compiled code cannot be kept" in capsys.readouterr().err
    assert not any(any(place.iterdir()) for place in places)


def test_a_folder_that_cannot_be_made_is_named_and_the_code_used(
    tmp_path, monkeypatch, made, capsys
):
    (tmp_path / "file").touch()
    monkeypatch.setenv("DUHAMEL_CACHE", str(tmp_path / "file" / "cache"))
    assert object_file._new_code() == CODE
    message = capsys.readouterr().err
    assert "compiled code cannot be kept (DUHAMEL_CACHE names a folder)" in message
    assert str(tmp_path / "file") in message
    assert len(made) == 1


def test_a_full_disk_leaves_no_half_file(cache, made, capsys):
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(CODE) // 2, limits[1]))
    try:
        assert object_file._new_code() == CODE
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert "cannot be kept" in capsys.readouterr().err
    assert [path.name for path in cache.iterdir()] == ["lock"]


def test_the_newest_files_stay(cache, made):
    cache.mkdir(mode=0o700)
    for k in range(20):
        path = cache / f"step-{k:016}.o"
        path.touch()
        os.utime(path, (k, k))
    object_file._new_code()
    left = sorted(path.name for path in cache.glob("step-*"))
    oldest = 20 + 1 - object_file.MAX_OBJECT_FILES
    numbers = [f"step-{k:016}.o" for k in range(oldest, 20)]
    assert left == sorted([*numbers, kept_file().name])


def test_the_newest_stock_folders_stay(cache, monkeypatch):
    for k in range(4):
        folder = cache / f"stock-{k}"
        (folder / "inside").mkdir(parents=True)
        os.utime(folder, (k, k))
    given = []
    stock = SimpleNamespace(bind=given.append)
    monkeypatch.setitem(sys.modules, "duhamel.solver.compiler.stock", stock)
    monkeypatch.setattr("duhamel.solver.compiler.stock", stock, raising=False)
    object_file._load_stock()
    own = f"stock-{digests.key()}"
    assert given == [cache / own]
    assert sorted(path.name for path in cache.iterdir()) == sorted(["stock-3", own])


def test_of_two_processes_that_start_at_once_one_builds(cache, tmp_path):
    program = f"""
import time
from duhamel.solver.compiler import object_file

def built(targets):
    with open({str(tmp_path / "log")!r}, "a") as log:
        log.write("built\\n")
    time.sleep(2)
    return [b"code"]

object_file._built_codes = built
assert object_file._new_code() == b"code"
"""
    both = [subprocess.Popen([sys.executable, "-c", program]) for _ in range(2)]
    assert [process.wait(60) for process in both] == [0, 0]
    assert (tmp_path / "log").read_text() == "built\n"


def test_the_process_that_builds_imports_nothing_from_the_folder_of_the_user(tmp_path, monkeypatch):
    for folder, code in (("package", CODE), ("user", b"planted")):
        module = tmp_path / folder / "planted" / "build.py"
        module.parent.mkdir(parents=True)
        (module.parent / "__init__.py").touch()
        text = f"import sys\ndef main(): sys.stdout.buffer.write({marks.OBJECT_MARK + code!r})\n"
        module.write_text(text, encoding="utf-8")
    monkeypatch.setattr(object_file, "__package__", "planted")
    monkeypatch.syspath_prepend(tmp_path / "package")
    monkeypatch.chdir(tmp_path / "user")
    assert object_file._built_codes(["host"]) == [CODE]


@pytest.mark.parametrize("python", ["none", "frozen", "lost"])
def test_without_a_python_to_start_code_is_built_in_the_process(monkeypatch, python):
    if python == "frozen":
        monkeypatch.setattr(sys, "frozen", True, raising=False)
    else:
        monkeypatch.setattr(sys, "executable", "" if python == "none" else "/nowhere/python")
    monkeypatch.setattr(object_file, "_built_here", lambda _: [CODE])
    assert object_file._built_codes(["host"]) == [CODE]


def test_targets_that_are_missing_are_made_together(cache, monkeypatch):
    asked = []

    def built(targets):
        asked.append(targets)
        return [target.encode() for target in targets]

    monkeypatch.setattr(object_file, "_built_codes", built)
    first, second = ["x86_64-linux"], ["aarch64-linux", "x86_64-linux", "x86_64-windows"]
    assert object_file.object_files(first) == {"x86_64-linux": b"x86_64-linux"}
    assert object_file.object_files(second) == {target: target.encode() for target in second}
    assert object_file.object_files(second)["aarch64-linux"] == b"aarch64-linux"
    assert asked == [first, ["aarch64-linux", "x86_64-windows"]]
    assert len({digests.key(target) for target in [*second, "host"]}) == 4


def test_the_key_is_of_the_layout_of_records_and_of_constants(monkeypatch):
    def key():
        digests.key.cache_clear()
        return digests.key()

    before = key()
    assert key() == before
    with monkeypatch.context() as patch:
        name, constant = next(
            (name, value)
            for name, value in vars(newton).items()
            if isinstance(value, float) and name in _names(newton)
        )
        patch.setattr(newton, name, 2.0 * constant)
        assert key() != before
    assert key() == before
    modules = {cls.__module__ for cls in marks.records()}
    files = [name for _, name, _ in iter_modules(records.__path__, f"{records.__name__}.")]
    assert modules == {system.__name__, *files}


def _names(module):
    functions = [f for f in marks.COMPILED_FUNCTIONS if f.__module__ == module.__name__]
    return {name for function in functions for name in function.__code__.co_names}


SHIM = """
import numba.core.codegen
del numba.core.codegen.JITCodeLibrary
"""
CHANGED = """
import sys
from pathlib import Path
from duhamel.solver.compiler import marks, shipped, stock
from duhamel.solver.step.elimination import factorize

shipped.SHIPPED_FOLDER = Path("nowhere")

def bind(folder):
    (folder / "kept.nbi").touch()
    for entry in marks.COMPILED_ENTRIES.values():
        entry.call = lambda *args: ("stock", *args)

stock.bind = bind
print(factorize(1, 2))
"""


@pytest.fixture
def changed_numba(tmp_path, cache):
    """An environment where numba has lost a class that `build` uses."""
    (tmp_path / "sitecustomize.py").write_text(SHIM)
    paths = [str(tmp_path), *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    return {"PYTHONPATH": os.pathsep.join(paths), "DUHAMEL_COMPILER": ""}


def test_where_numba_has_changed_the_stock_compiler_takes_over(changed_numba):
    done = run(CHANGED, **changed_numba)
    assert done.stdout == "('stock', 1, 2)\n"
    lines = done.stderr.splitlines()
    assert len(lines) == 3
    assert "about 52 seconds" in lines[0]
    assert "does not know this numba" in lines[1]
    assert "ImportError: cannot import name 'JITCodeLibrary'" in lines[1]
    assert "numba's public interface compiles now: three to four minutes" in lines[2]
    later = run(CHANGED, **changed_numba)
    assert (later.stdout, later.stderr) == (done.stdout, "")


def test_a_developer_sees_the_whole_failure_instead(changed_numba):
    with pytest.raises(subprocess.CalledProcessError) as failure:
        run(CHANGED, **changed_numba | {"DUHAMEL_COMPILER": "quick"})
    assert "Traceback" in failure.value.stderr
    assert "BuildError" in failure.value.stderr
    assert "cannot import name 'JITCodeLibrary'" in failure.value.stderr


CALLS = f"""
import os, sys, threading
sys.path.insert(0, {str(FOLDER)!r})
import every_part
"""

THREADS = (
    CALLS
    + """
start, found = threading.Barrier(4), [None] * 4

def work(k):
    start.wait()
    found[k] = every_part.run().body_position.tobytes()

threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert len(set(found)) == 1 and found[0] is not None
"""
)

FORKS = (
    CALLS
    + """
def in_a_child():
    reading, writing = os.pipe()
    if not (child := os.fork()):
        os.write(writing, every_part.run().body_position[-1].tobytes())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        content = pipe.read()
    assert os.waitpid(child, 0)[1] == 0
    return content

before = in_a_child()  # which loads
own = every_part.run().body_position[-1].tobytes()
after = in_a_child()
assert before == own == after != b""
"""
)


@pytest.mark.parametrize("program", [THREADS, FORKS], ids=["threads", "forks"])
def test_entries_are_called_by(program, compiled):
    assert compiled.exists() or object_file.compiler() == "shipped"
    run(program)


def test_a_fork_does_not_inherit_a_lock_that_is_held():
    held, released = threading.Event(), threading.Event()

    def hold():
        with object_file._lock:
            held.set()
            released.wait()

    thread = threading.Thread(target=hold)
    thread.start()
    held.wait()
    child = os.fork()
    if not child:
        os._exit(0 if object_file._lock.acquire(timeout=5) else 1)
    released.set()
    thread.join()
    assert os.waitpid(child, 0)[1] == 0


def test_this_session_runs_what_build_has_made(compiled):
    """Else a numba that `build` does not know would go unnoticed."""
    if os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        pytest.skip("all runs as Python")
    assert object_file._engines
    assert factorize.call.__code__.co_filename == "<string>"


PENDULUM = """
[simulation]
t_end = 0.01
step = 1e-3
gravity = [0, 0, -9.81]

[bodies.arm]
mass = 0.2
inertia = [1e-3, 1e-3, 2e-3]
position = [0.5, 0, 0]
frames.end = {position = [-0.5, 0, 0]}

[[joints]]
name = "pivot"
type = "revolute"
between = ["ground", "arm.end"]
axis = [0, 1, 0]
"""


def test_a_warm_run_imports_no_numba(compiled, tmp_path):
    model = tmp_path / "pendulum.toml"
    model.write_text(PENDULUM)
    program = f"""
import sys
from duhamel.cli import app
app(["run", {str(model)!r}, "-o", {str(tmp_path / "pendulum.h5")!r}], standalone_mode=False)
print(*sorted({{name.partition(".")[0] for name in sys.modules}}))
"""
    imported = set(run(program).stdout.splitlines()[-1].split())
    assert "llvmlite" in imported
    assert "numba" not in imported
