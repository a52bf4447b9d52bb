"""A log of long work outlives whoever writes it, and is never mixed up or thrown away."""

from lta_config.errors import BadInput
from lta_report.study_store import LineLog, LogKind
import pytest

KIND = LogKind('numbers.jsonl', 'count', 'search', '--folder')


def opened(folder, identity='mine'):
    return LineLog(folder, KIND, identity, lambda content: content['n'])


def kept(folder):
    """Return what a log holds, and leave it to others."""
    log = opened(folder)
    log.close()
    return log.pieces


@pytest.fixture
def three(tmp_path):
    """Return the file of a log of three pieces."""
    log = opened(tmp_path / 'new')
    for n in range(3):
        log.append({'n': n})
    log.close()
    return tmp_path / 'new' / KIND.file


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
    assert three.read_bytes() == whole[: -len('{"n": 2}\n')]


def test_a_first_line_that_was_torn_off_is_written_again(three):
    begin = three.read_bytes().splitlines(keepends=True)[0]
    for end in range(len(begin)):
        three.write_bytes(begin[:end])
        assert kept(three.parent) == []
        assert three.read_bytes() == begin


@pytest.mark.parametrize(
    ('content', 'sentence'),
    [
        (b'{"count": "yours"}\n{"n": 1}\n', 'is the log of a search with other settings; '),
        (b'garbage\n', 'is not the log of a search; choose another folder with --folder.'),
        (b'garbage', 'is not the log of a search'),
        (b'\xff\xfe\n{"n": 1}\n', 'is not the log of a search'),
        (b'[1]\n', 'is not the log of a search'),
        (b'{"other": "mine"}\n', 'is not the log of a search'),
        (b'{"count": "mine"}\n{"m": 1}\n', 'is not the log of a search'),
        (b'{"count": "mine"}\n7\n', 'is not the log of a search'),
    ],
)
def test_the_log_of_something_else_is_refused_and_not_touched(tmp_path, content, sentence):
    path = tmp_path / KIND.file
    path.write_bytes(content)
    with pytest.raises(BadInput) as refused:
        opened(tmp_path)
    assert str(refused.value).startswith(f"'{path}' {sentence}")
    assert path.read_bytes() == content


def test_one_writes_at_a_time(tmp_path):
    log = opened(tmp_path)
    with pytest.raises(BadInput, match=r'Another search is writing .* wait until it ends'):
        opened(tmp_path)
    log.append({'n': 5})
    log.close()
    assert kept(tmp_path) == [5]


def test_a_full_disk_is_a_sentence_and_what_was_kept_stays(three, room):
    log = opened(three.parent)
    whole = three.read_bytes()
    with room(len(whole) + 4):
        with pytest.raises(BadInput, match=r'free disk space and start the search again'):
            log.append({'n': 3})
        log.close()
    assert three.stat().st_size == len(whole) + 4
    assert kept(three.parent) == [0, 1, 2]
    assert three.read_bytes() == whole


def test_a_full_disk_at_the_beginning_is_a_sentence(tmp_path, room):
    with room(4), pytest.raises(BadInput, match=r'free disk space'):
        opened(tmp_path)
    assert kept(tmp_path) == []


def test_a_folder_that_cannot_be_made_is_a_sentence(tmp_path):
    (tmp_path / 'file').touch()
    with pytest.raises(
        BadInput, match=r'cannot be written \(.*choose another folder with --folder'
    ):
        opened(tmp_path / 'file' / 'new')
