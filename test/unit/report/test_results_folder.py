"""Results appear when all are there, or none does."""

from lta_config.errors import BadInput
from lta_discovery.results.overlay import format_topic_names
from lta_report.results_folder import check_creatable, stage_results
import pytest


def test_results_appear_together_and_the_last_one_last(tmp_path, monkeypatch):
    folder = tmp_path / 'out'
    moved = []
    with stage_results(folder, 'b') as part:
        for name in 'cba':
            (part / name).write_text(name)
        assert [one.name for one in folder.iterdir()] == [part.name]
        rename = type(part).rename
        monkeypatch.setattr(
            type(part), 'rename', lambda one, to: (moved.append(to.name), rename(one, to))
        )
    assert sorted(moved[:2]) == ['a', 'c']
    assert moved[2:] == ['b']
    assert {one.name: one.read_text() for one in folder.iterdir()} == {n: n for n in 'abc'}


@pytest.mark.parametrize('fault', [KeyboardInterrupt, OSError])
def test_nothing_half_written_stays(tmp_path, fault):
    held = tmp_path / 'held'
    held.mkdir()
    (held / 'flights').write_text('')

    def stopped(folder):
        with stage_results(folder, 'b') as part:
            (part / 'a').write_text('a')
            raise fault

    for folder in (tmp_path / 'new', held):
        with pytest.raises(fault):
            stopped(folder)
    assert [one.name for one in tmp_path.iterdir()] == ['held']
    assert [one.name for one in held.iterdir()] == ['flights']


def test_a_folder_that_cannot_be_is_refused_before_the_work(tmp_path):
    (tmp_path / 'file').write_text('')
    check_creatable(tmp_path / 'new' / 'newer')
    for place, said in ((tmp_path, 'not empty'), (tmp_path / 'file' / 'x', 'not a writable')):
        with pytest.raises(BadInput, match=said):
            check_creatable(place)
    assert [one.name for one in tmp_path.iterdir()] == ['file']


def test_flights_whose_names_differ_by_a_sign_have_topics_of_their_own():
    assert format_topic_names(['a-b', 'a b', '1', 'Ä', 'Ö']) == [
        'a_b', 'a_b_2', 'flight_1', 'flight_', 'flight__2',
    ]  # fmt: skip


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / 'file').write_text('')
    with (
        pytest.raises(BadInput, match='cannot be created'),
        stage_results(tmp_path / 'file' / 'a', 'b'),
    ):
        pass
