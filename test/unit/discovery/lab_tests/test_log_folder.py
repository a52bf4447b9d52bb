# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Logs of a folder: what is a log, and which mapping it gets."""

from pathlib import Path

from lta_config.errors import BadInput
from lta_data.importers.draft.draft_mapping import measure_size
from lta_discovery.lab_tests.log_folder import LabLogs, open_lab_folder
import numpy as np
import pytest

HEAD = 't,x,y,z,qx,qy,qz,qw,fx,fy,fz'


def write_log(path: Path, height: float = 1.5, head: str = HEAD) -> None:
    """Write a second of a vehicle at rest."""
    rows = np.zeros((40, 11))
    rows[:, 0], rows[:, 3], rows[:, 7] = 0.02 * np.arange(40) + 5.0, height, 1.0
    rows[:, 1] = 0.01 * np.arange(40)
    np.savetxt(path, rows, delimiter=',', header=head, comments='', fmt='%.4f')


def opened(folder: Path, scratch: Path, mapping: str | None = None) -> LabLogs:
    scratch.mkdir()
    return open_lab_folder(folder, mapping, {}, 'gtmab', scratch, lambda _: None)


def test_logs_with_the_same_columns_share_one_draft(tmp_path: Path) -> None:
    folder = tmp_path / 'lab'
    folder.mkdir()
    for name in ('b', 'a'):
        write_log(folder / f'{name}.csv')
    (folder / 'notes.md').write_text('Windows closed.')
    found = opened(folder, tmp_path / 'scratch')
    assert [bag.name for bag in found.bags] == ['a', 'b']
    assert list(found.drafts) == ['mapping.yaml']
    assert 'force: {columns: [fx, fy, fz], unit: N}' in found.drafts['mapping.yaml']
    # A bag is taken as it is, whatever mapping lies beside it
    again = opened(tmp_path / 'scratch', tmp_path / 'other')
    assert again.bags == [tmp_path / 'scratch/a', tmp_path / 'scratch/b']
    assert not again.drafts


def test_a_mapping_beside_the_log_is_used(tmp_path: Path) -> None:
    folder = tmp_path / 'lab'
    folder.mkdir()
    write_log(folder / 'swing.csv')
    text = opened(folder, tmp_path / 'first').drafts['mapping.yaml']
    (folder / 'swing.yaml').write_text(text)
    assert not opened(folder, tmp_path / 'second').drafts
    (folder / 'swing.yaml').rename(folder / 'mapping.yaml')
    assert not opened(folder, tmp_path / 'third').drafts


def test_a_folder_log_is_as_large_as_its_files(tmp_path: Path) -> None:
    (tmp_path / 'inner').mkdir()
    (tmp_path / 'a.csv').write_text('12345')
    (tmp_path / 'inner/b.csv').write_text('123')
    assert measure_size(tmp_path) == 8
    assert measure_size(tmp_path / 'a.csv') == 5


def test_names_with_dots_are_different_logs(tmp_path: Path) -> None:
    folder = tmp_path / 'lab'
    folder.mkdir()
    for name in ('2026.11.26', '2026.11.27'):
        write_log(folder / f'{name}.csv')
    (folder / '2026.11.26.txt').write_bytes((folder / '2026.11.26.csv').read_bytes())
    text = opened(folder, tmp_path / 'first').drafts['mapping.yaml']
    for name in ('2026.11.26', '2026.11.27'):
        (folder / f'{name}.yaml').write_text(text)
    found = opened(folder, tmp_path / 'second')
    assert [bag.name for bag in found.bags] == ['2026.11.26', '2026.11.26.txt', '2026.11.27']
    assert not found.drafts


def test_two_readings_ask_with_the_option_that_decides(tmp_path: Path) -> None:
    """Heights on both sides of zero, and no gravity: up or down?"""
    folder = tmp_path / 'lab'
    folder.mkdir()
    write_log(folder / 'float.csv', height=0.0)
    with pytest.raises(
        BadInput, match=r"'float.csv': .* Decide with --set world\.up=\w+ \(.*\) or"
    ):
        opened(folder, tmp_path / 'scratch')


def test_a_folder_of_runs_is_no_log(tmp_path: Path) -> None:
    """Of other tests, as the tutorial has beside its own."""
    runs = tmp_path / 'lab' / 'unseen'
    runs.mkdir(parents=True)
    for name in ('a', 'b'):
        write_log(runs / f'{name}.csv')
    with pytest.raises(BadInput, match='holds no bag and no log file'):
        opened(tmp_path / 'lab', tmp_path / 'scratch')


@pytest.mark.parametrize(('made', 'said'), [(False, 'is not a folder'), (True, 'holds no bag')])
def test_a_folder_without_logs_is_refused(tmp_path: Path, made: bool, said: str) -> None:
    if made:
        (tmp_path / 'lab').mkdir()
    with pytest.raises(BadInput, match=said):
        opened(tmp_path / 'lab', tmp_path / 'scratch')
