import os

import pytest

from vaso.local.cores import physical_cores


@pytest.fixture
def machine(tmp_path):
    """A machine with four processors on two cores."""
    for number, siblings in enumerate(("0,2", "1,3", "0,2", "1,3")):
        write(
            tmp_path, f"sys/devices/system/cpu/cpu{number}/topology/thread_siblings_list", siblings
        )
    write(tmp_path, "proc/self/cgroup", "0::/box/inner")
    return tmp_path


def write(root, name, text):
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text + "\n")


def test_two_threads_of_a_core_count_once(machine):
    assert physical_cores(machine, range(4)) == 2


def test_affinity_counts(machine):
    assert physical_cores(machine, [0, 2]) == 1
    assert physical_cores(machine, [0, 1, 2]) == 2


@pytest.mark.parametrize(
    ("file", "quota", "cores"),
    [
        ("sys/fs/cgroup/box/cpu.max", "100000 100000", 1),
        ("sys/fs/cgroup/box/inner/cpu.max", "150000 100000", 2),
        ("sys/fs/cgroup/cpu.max", "50000 100000", 1),
        ("sys/fs/cgroup/box/cpu.max", "max 100000", 2),
        ("sys/fs/cgroup/other/cpu.max", "100000 100000", 2),
        ("sys/fs/cgroup/box/cpu.max", "nonsense", 2),
    ],
)
def test_the_quota_of_the_control_groups_counts(machine, file, quota, cores):
    write(machine, file, quota)
    assert physical_cores(machine, range(4)) == cores


@pytest.mark.parametrize(("quota", "cores"), [("100000", 1), ("-1", 2)])
def test_the_older_control_groups_count(machine, quota, cores):
    write(machine, "sys/fs/cgroup/cpu/cpu.cfs_quota_us", quota)
    write(machine, "sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000")
    assert physical_cores(machine, range(4)) == cores


def test_where_nothing_is_known_every_processor_is_a_core(tmp_path):
    assert physical_cores(tmp_path, range(3)) == 3


def test_this_machine():
    assert 1 <= physical_cores() <= (os.cpu_count() or 1)
