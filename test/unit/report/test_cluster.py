# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A cluster of other versions is refused in one sentence, and never listens without encryption."""

import subprocess
import sys
from types import SimpleNamespace

from lta_config.errors import BadInput
from lta_report import cluster
from lta_report.cluster import check_software, ClusterSoftware, connect_cluster
import pytest

cloudpickle = pytest.importorskip('cloudpickle', reason='it comes with dask.distributed')
OURS = ClusterSoftware('1.0.0', 'a' * 40, '3.11', '2026.8.0')
PACKAGES = {'python': '3.11.7.final.0', 'distributed': '2026.8.0'}


class FakeClient:
    """Of a scheduler with one worker."""

    def __init__(self, software=('1.0.0', 'a' * 40), packages=None, scheduler=None):
        self.scheduler = SimpleNamespace(address='tcp://s')
        self._software, self._packages = software, PACKAGES | (packages or {})
        self._scheduler = scheduler or ('1.0.0', 'a' * 40)

    def get_versions(self):
        return {
            'scheduler': {'packages': PACKAGES},
            'workers': {'tcp://w': {'packages': self._packages}},
        }

    def run(self, _):
        assert self._packages['python'].startswith('3.11'), 'another Python cannot read our code'
        return {'tcp://w': self._software}

    def run_on_scheduler(self, _):
        return self._scheduler


@pytest.fixture(autouse=True)
def ours(monkeypatch):
    monkeypatch.setattr(cluster, 'read_software', lambda: OURS)
    monkeypatch.setattr(cluster.platform, 'python_version', lambda: '3.11.9')
    monkeypatch.setattr(cluster, 'VERSION', '1.0.0')


@pytest.mark.parametrize('commit', ['a' * 40, 'unknown'])
def test_the_same_software_is_accepted(commit):
    check_software(FakeClient(('1.0.0', commit)))


@pytest.mark.parametrize(
    ('client', 'theirs'),
    [
        (FakeClient(('1.1.0', 'a' * 40)), f'worker tcp://w has LTA 1.1.0 (commit {"a" * 12}), Py'),
        (FakeClient(('1.0.0', 'b' * 40)), f'worker tcp://w has LTA 1.0.0 (commit {"b" * 12}), Py'),
        (FakeClient(('1.0.0', 'a' * 40 + '-dirty')), f'(commit {"a" * 12}-dirty), Python 3.11'),
        (FakeClient(packages={'python': '3.12.1.final.0'}), 'worker tcp://w has Python 3.12 and'),
        (FakeClient(packages={'distributed': '2025.1.0'}), 'Python 3.11 and Dask 2025.1.0'),
        (FakeClient(('', '')), 'The worker tcp://w has no LTA'),
        (FakeClient(scheduler=('', '')), 'The scheduler tcp://s has no LTA'),
    ],
)  # fmt: skip
def test_other_software_is_one_sentence(client, theirs):
    with pytest.raises(BadInput) as caught:
        check_software(client)
    text = str(caught.value)
    assert theirs in text
    assert (
        f'this machine has LTA 1.0.0 (commit {"a" * 12}), Python 3.11 and Dask 2026.8.0;' in text
    )
    assert len(text.splitlines()) == 1


def test_a_process_without_lta_can_answer():
    """Dask sends functions with cloudpickle; -I hides LTA from the other Python."""
    code = cloudpickle.dumps(cluster.build_lta_reader())
    ask = f'import cloudpickle; print(cloudpickle.loads({code!r})())'
    done = subprocess.run([sys.executable, '-I', '-c', ask], capture_output=True, text=True)
    assert done.stdout == "('', '')\n", done.stderr


def test_a_scheduler_without_workers_is_one_sentence(monkeypatch):
    distributed = cluster.import_dask()
    monkeypatch.setattr(cluster, 'SCHEDULER_PATIENCE', 0.1)
    options = {'n_workers': 0, 'processes': False, 'protocol': 'tcp', 'dashboard_address': None}
    with (
        distributed.LocalCluster(**options) as empty,
        pytest.raises(BadInput, match='start some with "dask worker tcp:'),
    ):
        connect_cluster(empty.scheduler_address)
