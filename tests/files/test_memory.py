"""Memory that is left, by the files in which Linux says so."""

import pytest
from duhamel.files.memory import available


@pytest.fixture
def root(tmp_path):
    """A machine with 8 MB left."""
    put(
        tmp_path,
        "proc/meminfo",
        "MemTotal:       16000 kB\nMemFree:   2000 kB\nMemAvailable:   8000 kB\n",
    )
    return tmp_path


def put(root, path, text):
    file = root / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def test_of_the_machine(root):
    assert available(root) == 8000 * 1024


def test_of_groups_within_groups(root):
    """The outer group binds: 3 000 000 less 1 000 000 in use, of which 200 000 are files that give
    way.
    """
    put(root, "proc/self/cgroup", "0::/job/step\n")
    for group, most, used in (("job", "3000000", 1_000_000), ("job/step", "max", 900_000)):
        put(root, f"sys/fs/cgroup/{group}/memory.max", f"{most}\n")
        put(root, f"sys/fs/cgroup/{group}/memory.current", f"{used}\n")
        put(root, f"sys/fs/cgroup/{group}/memory.stat", "anon 5\ninactive_file 200000\n")
    assert available(root) == 2_200_000


def test_of_groups_of_the_first_version(root):
    put(root, "proc/self/cgroup", "4:cpu,cpuacct:/job\n3:memory:/job\n0::/\n")
    for group, most in (("", 9223372036854771712), ("job", 500_000)):
        put(root, f"sys/fs/cgroup/memory/{group}/memory.limit_in_bytes", str(most))
        put(root, f"sys/fs/cgroup/memory/{group}/memory.usage_in_bytes", "100000")
        put(
            root,
            f"sys/fs/cgroup/memory/{group}/memory.stat",
            "cache 7\ntotal_inactive_file 20000\n",
        )
    assert available(root) == 420_000


def test_a_container_that_sees_its_own_group_as_the_whole(root):
    """The path is that of the host, which is not mounted."""
    put(root, "proc/self/cgroup", "0::/docker/abc\n")
    put(root, "sys/fs/cgroup/memory.max", "1000000")
    put(root, "sys/fs/cgroup/memory.current", "400000")
    put(root, "sys/fs/cgroup/memory.stat", "inactive_file 0\n")
    assert available(root) == 600_000
