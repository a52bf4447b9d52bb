# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""A store of long work outlives whoever writes it, and is never mixed up or thrown away."""

from lta_config.errors import BadInput
from lta_report.study_store import StoreFormat, StudyStore
from pydantic import TypeAdapter
import pytest

FORM = StoreFormat('numbers.jsonl', 'count', 'search', TypeAdapter(int), shares_folder=True)


def opened(folder, identity='mine'):
    return StudyStore(folder, FORM, identity)


def kept(folder):
    """Return what a store holds, and leave it to others."""
    with opened(folder) as store:
        return [*store.results.values()]


@pytest.fixture
def three(tmp_path):
    """Return the file of a store of three numbers."""
    with opened(tmp_path / 'new') as store:
        for n in range(3):
            store.add(str(n), n)
    return tmp_path / 'new' / FORM.file


def test_what_is_kept_is_taken_up_again_and_the_file_is_left_as_it_is(three):
    before, file = three.read_bytes(), three.stat().st_ino
    assert kept(three.parent) == [0, 1, 2]
    assert three.read_bytes() == before
    assert three.stat().st_ino == file
    assert len(before.splitlines()) == 4


@pytest.mark.parametrize('torn', range(1, 10))
def test_a_torn_tail_is_cut_off_and_nothing_else(three, torn):
    whole = three.read_bytes()
    three.write_bytes(whole[:-torn])
    assert kept(three.parent) == [0, 1]
    assert three.read_bytes() == whole[: -len('{"key": "2", "result": 2}\n')]


def test_a_first_line_that_was_torn_off_is_written_again(three):
    begin = three.read_bytes().splitlines(keepends=True)[0]
    for end in range(len(begin)):
        three.write_bytes(begin[:end])
        assert kept(three.parent) == []
        assert three.read_bytes() == begin


@pytest.mark.parametrize(
    ('content', 'sentence'),
    [
        (b'{"count": "yours"}\n', 'is the log of a search with other settings; '),
        (b'garbage\n', 'is not the log of a search; choose another folder with --out.'),
        (b'garbage', 'is not the log of a search'),
        (b'\xff\xfe\n{"n": 1}\n', 'is not the log of a search'),
        (b'[1]\n', 'is not the log of a search'),
        (b'{"other": "mine"}\n', 'is not the log of a search'),
        (b'{"count": "mine"}\n{"m": 1}\n', 'is not the log of a search'),
        (b'{"count": "mine"}\n7\n', 'is not the log of a search'),
    ],
)
def test_the_log_of_something_else_is_refused_and_not_touched(tmp_path, content, sentence):
    path = tmp_path / FORM.file
    path.write_bytes(content)
    with pytest.raises(BadInput) as refused:
        opened(tmp_path)
    assert str(refused.value).startswith(f"'{path}' {sentence}")
    assert path.read_bytes() == content


def test_one_writes_at_a_time(tmp_path):
    with opened(tmp_path) as store:
        with pytest.raises(BadInput, match=r'Another search is writing .* wait until it ends'):
            opened(tmp_path)
        store.add('5', 5)
    assert kept(tmp_path) == [5]


def test_a_full_disk_is_a_sentence_and_what_was_kept_stays(three, room):
    whole = three.read_bytes()
    with opened(three.parent) as store, room(len(whole) + 4):
        with pytest.raises(BadInput, match=r'free disk space and start the search again'):
            store.add('3', 3)
        store.__exit__()
    assert three.stat().st_size == len(whole) + 4
    assert kept(three.parent) == [0, 1, 2]
    assert three.read_bytes() == whole


def test_a_full_disk_at_the_beginning_is_a_sentence(tmp_path, room):
    with room(4), pytest.raises(BadInput, match=r'free disk space'):
        opened(tmp_path)
    assert kept(tmp_path) == []


def test_a_folder_that_cannot_be_made_is_a_sentence(tmp_path):
    (tmp_path / 'file').touch()
    with pytest.raises(BadInput, match=r'cannot be written \(.*choose another folder with --out'):
        opened(tmp_path / 'file' / 'new')
