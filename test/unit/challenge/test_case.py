"""Cases are drawn from seed and number alone, and their answers stay out of sight."""

from pathlib import Path
import shutil

from lta_challenge.answer_key import NAME, read_answers, write_answers
from lta_challenge.case import CaseGenerator, ChallengeCase, wrench_strength
from lta_challenge.course import COURSES
from lta_challenge.effect_injection import CLEAR, list_injectable_parameters
from lta_challenge.make import (
    case_folder,
    ChallengeRequest,
    generate_challenge,
    load_challenge_vehicle,
)
from lta_challenge.outside import OUTSIDE, RESERVED, STRANGE, STRUCTURED
from lta_challenge.rows import find_challenge_row, Kind, KINDS, ROWS
from lta_challenge.score import score_challenge
from lta_challenge.truth_vehicle import build_truth_model
from lta_config.errors import BadInput
from lta_data.bag.recorded_flight import open_flight
from lta_report.study import StudyOptions
import numpy as np
import pytest
from rich.console import Console

SHORT = (20.0, 24.0)


def drawn(
    number: int, kind: Kind | None = None, row_name: str = 'base', seed: int = 2
) -> ChallengeCase:
    """Draw a short case."""
    return CaseGenerator(
        load_challenge_vehicle(), seed, number, row_name, kind, SHORT
    ).generate_case()


def test_a_case_depends_on_seed_and_number_alone() -> None:
    first, again, other = drawn(3), drawn(3), drawn(4)
    assert first.answer == again.answer != other.answer
    for one, two in zip(first.flights, again.flights, strict=True):
        for topic, (time, values) in one.streams.items():
            assert np.array_equal(time, two.streams[topic][0])
            assert np.array_equal(values, two.streams[topic][1], equal_nan=True)


def test_kinds_hide_what_they_say() -> None:
    for kind, (count, outside) in {
        'clean': (0, False), 'single': (1, False), 'pair': (2, False), 'outside': (0, True),
        'mixed': (1, True),
    }.items():  # fmt: skip
        answer = drawn(1, kind).answer  # type: ignore[arg-type]
        assert len(answer['hidden']) == count
        assert bool(answer['outside']) == outside
        assert (answer['floors'] > 0.0) == (answer['size'] > 0.0) == outside
    assert sum(KINDS.values()) == pytest.approx(1.0)


# The other simulator has a pilot, and tests, of its own.
@pytest.mark.parametrize(
    'name', [name for name in ROWS if not find_challenge_row(name).independent]
)
def test_each_row_records_what_it_says(name: str) -> None:
    case = drawn(0, 'clean', name)
    command = 'wrench_command' if find_challenge_row(name).pushed else 'motors'
    for flight in case.flights:
        assert set(flight.streams) == {*find_challenge_row(name).topics, command}
        assert flight.course in find_challenge_row(name).courses
        time = flight.streams[command][0]
        assert SHORT[0] - 1.0 <= time[-1] <= SHORT[1] + 1.0
        height = flight.streams['ground_truth/odom'][1][:, 2]
        assert 0.3 < np.median(height) < 5.0


@pytest.mark.long
def test_what_is_outside_comes_to_the_strength_that_was_drawn() -> None:
    reached = [drawn(number, 'outside').answer['floors'] for number in range(12)]
    assert sum(0.4 * CLEAR[0] < each < 1.6 * CLEAR[1] for each in reached) >= 11
    assert wrench_strength(np.outer(np.sin(np.arange(6283) * 1e-3), [4e-3, 0, 0, 0, 0, 0])) == (
        pytest.approx(10.0 / np.sqrt(2.0), rel=1e-3)
    )


def test_the_strength_in_several_flights_is_their_root_mean_square() -> None:
    wave = np.outer(np.sin(np.arange(6283) * 1e-3), [4e-3, 0, 0, 0, 0, 0])
    # 10 and 20 noise floors of 0.4 mN, and a mean that does not count
    together = wrench_strength(wave + 1e-3, 2.0 * wave)
    assert together == pytest.approx(np.sqrt((50.0 + 200.0) / 2.0), rel=1e-3)


def test_what_is_outside_is_known_to_the_truth_alone() -> None:
    assert len(OUTSIDE) >= 8
    assert not set(RESERVED) & {*OUTSIDE, *STRUCTURED}  # no challenge draws them
    assert set(STRANGE) == {*OUTSIDE, *STRUCTURED, *RESERVED} == set(build_truth_model().strange)
    for name, kind in STRANGE.items():
        assert kind.effect.name == name
        assert kind.effect.parameters[0].name == 'size'
        assert set(kind.usual) <= {known.name for known in kind.effect.parameters}


def test_only_what_such_data_can_show_is_hidden() -> None:
    names = {
        knob.name
        for knob in list_injectable_parameters(
            load_challenge_vehicle().knobs, find_challenge_row('pose')
        )
    }
    assert 'range_offset.offset' not in names
    assert 'superheat.warming' not in {
        k.name
        for k in list_injectable_parameters(
            load_challenge_vehicle().knobs, find_challenge_row('base')
        )
    }
    assert {'linear_drag.surge', 'motor_lag', 'tracker_delay.delay'} <= names
    assert set(COURSES) == {course for each in ROWS.values() for course in each.courses}


def test_bags_say_nothing_of_what_is_hidden(tmp_path: Path) -> None:
    folder = tmp_path / 'challenge'
    generate_challenge(ChallengeRequest(5, 1, 'base', 'single', SHORT), folder)
    hidden = read_answers(folder / NAME)['0']['hidden'][0]['knob']
    case = folder / case_folder(0)
    files = [path for path in case.rglob('*') if path.is_file()]
    assert {path.name for path in files} >= {'vehicle.yaml', 'metadata.yaml', 'train_0.mcap'}
    effect = hidden.partition('.')[0].encode()
    for path in [*files, folder / 'challenge.json', folder / NAME]:
        if path.name != 'vehicle.yaml':
            assert effect not in path.read_bytes()
    flight = open_flight(case / 'train')
    streams = drawn_like(folder)
    said = flight.read_series('motors')
    assert len(said) == len(streams['motors'][0])
    assert said.numbers['effort[2]'] == pytest.approx(streams['motors'][1][:, 2], abs=1e-12)
    place = flight.read_series('ground_truth/odom').vector('pose.pose.position')
    assert place == pytest.approx(streams['ground_truth/odom'][1][:, :3], abs=1e-12)


def drawn_like(folder: Path) -> dict:  # type: ignore[type-arg]
    """Return the streams of the first flight of that challenge, drawn again."""
    assert folder.is_dir()
    return dict(
        CaseGenerator(load_challenge_vehicle(), 5, 0, 'base', 'single', SHORT)
        .generate_case()
        .flights[0]
        .streams
    )


def test_answers_that_were_changed_are_refused(tmp_path: Path) -> None:
    path = tmp_path / NAME
    write_answers({'0': {'hidden': []}}, path)
    assert read_answers(path) == {'0': {'hidden': []}}
    note, digest, data = path.read_text().splitlines()
    path.write_text(f'{note}\n{digest[::-1]}\n{data}\n')
    with pytest.raises(BadInput, match='changed after it was created'):
        read_answers(path)
    path.write_text('something else\n')
    with pytest.raises(BadInput, match='is not a valid answer key'):
        read_answers(path)


def test_a_challenge_of_which_something_is_gone_is_not_scored(tmp_path: Path) -> None:
    folder = tmp_path / 'hidden'
    generate_challenge(ChallengeRequest(5, 1, 'base', 'clean', SHORT), folder)
    assert sorted(one.name for one in folder.iterdir()) == [NAME, 'case_0000', 'challenge.json']
    shutil.rmtree(folder / 'case_0000')
    with pytest.raises(BadInput, match='is missing'):
        score_challenge(folder, StudyOptions(workers=1), Console())
    write_answers({'0': {'hidden': []}}, folder / NAME)
    with pytest.raises(BadInput, match='changed after it was created'):
        score_challenge(folder, StudyOptions(workers=1), Console())


def test_a_challenge_that_is_stopped_leaves_nothing(tmp_path: Path) -> None:
    def stop() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        generate_challenge(
            ChallengeRequest(5, 2, 'base', 'clean', SHORT), tmp_path / 'hidden', 1, stop
        )
    assert list(tmp_path.iterdir()) == []
