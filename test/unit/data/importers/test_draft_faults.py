# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Logs with faults are drafted, or their user learns in a sentence what is wrong."""

import io

from lta_analysis.import_draft import ask_user, build_draft_report
from lta_config.errors import BadInput
from lta_data.importers.draft.choices import DraftQuestion
from lta_data.importers.draft.draft_mapping import draft_mapping
from lta_data.importers.run import import_logs, ImportRequest
import numpy as np
import pytest
from rich.console import Console
import yaml

from .lab_flights import lab_flight, three, write_csv


def list_columns(**changes):
    """Return the columns of a flight with poses and forces, some of them changed."""
    f = lab_flight()
    rng = np.random.default_rng(3)
    forces = {name: np.repeat(rng.uniform(-1.0, 1.0, 30), 50) for name in ('fx_N', 'fz_N')}
    columns = {'t': f['t'] + 9.0, **three('p', f['p']), **three('q', f['q'], 'xyzw'), **forces}
    return columns | changes


def list_notes(path, answers):
    draft = draft_mapping(path, answers)
    return ' '.join(build_draft_report(path, draft, {}).data['notes'])


@pytest.mark.parametrize('lost', [slice(200, 400), slice(0, 50), slice(-50, None)])
@pytest.mark.parametrize('column', ['t', 'px', 'fx_N'])
def test_cells_without_a_number_are_no_hindrance(tmp_path, column, lost):
    columns = list_columns()
    columns[column] = columns[column].copy()
    columns[column][lost] = np.nan
    topics = yaml.safe_load(draft_mapping(write_csv(tmp_path / 'a.csv', columns), {}).text)
    assert [one['topic'] for one in topics['topics']] == ['ground_truth/odom', 'wrench_command']


def test_a_column_of_times_that_do_not_rise_is_named(tmp_path):
    still = write_csv(tmp_path / 'a.csv', list_columns(t=np.full(1500, 9.0)))
    question = draft_mapping(still, {}).choices.questions[0]
    assert question.key == 'time.rate'
    assert question.reason.startswith("Column 't' does not rise from row to row, so it is no time")
    # The options are examples
    assert 'time: {rate: 30 Hz}' in draft_mapping(still, {'time.rate': '30'}).text
    with pytest.raises(BadInput, match=r"--set time\.rate is 'fast', but must be rows per second"):
        draft_mapping(still, {'time.rate': 'fast'})
    text = still.read_text().splitlines()
    rows = [f'10h00m{k:02d},{line.partition(",")[2]}' for k, line in enumerate(text[1:60])]
    still.write_text('\n'.join([text[0], *rows]))
    question = draft_mapping(still, {}).choices.questions[0]
    assert question.reason.startswith("Column 't' has cells such as '10h00m00', neither")


def test_a_tracker_without_an_attitude_gives_none(tmp_path):
    zeros = dict.fromkeys(('qx', 'qy', 'qz', 'qw'), np.zeros(1500))
    path = write_csv(tmp_path / 'a.csv', list_columns(**zeros))
    (pose, _) = yaml.safe_load(draft_mapping(path, {}).text)['topics']
    assert 'orientation' not in pose
    notes = list_notes(path, {})
    assert 'Columns without a number but zero: qx, qy, qz, qw.' in notes
    assert 'Columns without a meaning' not in notes
    assert 'The mapping has no attitude' in notes


@pytest.mark.parametrize('length', [1.7, 2.0**30])
def test_quaternions_of_another_length_are_divided_by_it(tmp_path, bring, length):
    f = lab_flight()
    path = write_csv(tmp_path / 'a.csv', list_columns(**three('q', length * f['q'], 'xyzw')))
    draft = draft_mapping(path, {})
    (said,) = [one.reason for one in draft.choices.reasons if one.reading == 'quaternion']
    assert 'and are divided by it' in said
    pose = bring(path, draft.text).messages['/lta1/ground_truth/odom'][300].pose.pose.orientation
    assert (pose.x, pose.y, pose.z, pose.w) == pytest.approx(tuple(f['q'][300]), abs=1e-5)


def test_units_below_the_names_may_repeat_those_in_the_names(tmp_path):
    path = write_csv(tmp_path / 'a.csv', list_columns())
    head, *rows = path.read_text().splitlines()
    path.write_text('\n'.join([head, 's,m,m,m,,,,,N,N', *rows]))
    (_, wrench) = yaml.safe_load(draft_mapping(path, {}).text)['topics']
    assert wrench['force']['columns'] == ['fx_N [n]', None, 'fz_N [n]']


def test_an_open_question_takes_other_answers_than_its_examples(monkeypatch):
    console = Console(file=io.StringIO(), width=80, record=True)
    answers = iter(['', '0.15 N'])
    monkeypatch.setattr('builtins.input', lambda: next(answers))
    question = DraftQuestion('surge.largest', [('0.1 N', 'for example')], 'How much?', True)
    assert ask_user(question, console) == '0.15 N'
    assert 'surge.largest (such as 0.1 N):' in console.export_text()


def test_files_without_rows_in_a_folder_are_left_out_and_named(tmp_path):
    folder = tmp_path / 'tests'
    folder.mkdir()
    write_csv(folder / 'a.csv', list_columns())
    (folder / 'b.csv').write_text('')
    (folder / 'notes.txt').write_text('Windy.\nThe door was open.\n')
    draft = draft_mapping(folder, {})
    assert draft.source.path == folder / 'a.csv'
    assert draft.source.notes == [
        'The 1 file of tests is one run.',
        'Left out, as they hold no rows of numbers: b.csv, notes.txt.',
    ]
    (tmp_path / 'mapping.yaml').write_text(draft.text)
    request = ImportRequest([folder], str(tmp_path / 'mapping.yaml'))
    (done,) = import_logs(request, tmp_path / 'out')
    assert done.notes[-1] == 'Left out, as they hold no rows of numbers: b.csv, notes.txt.'


def test_an_attitude_that_was_never_measured_is_left_out(tmp_path):
    f = lab_flight()
    nothing = np.full((len(f['t']), 4), np.nan)
    columns = {'t': f['t'], **three('p', f['p']), **three('q', nothing, 'xyzw')}
    draft = draft_mapping(write_csv(tmp_path / 'a.csv', columns), {})
    (topic,) = yaml.safe_load(draft.text)['topics']
    assert topic['position']['columns'] == ['px', 'py', 'pz']
    assert 'orientation' not in topic
    assert any('never measured' in one.reason for one in draft.choices.reasons)


@pytest.mark.parametrize(
    ('text', 'sentence'),
    [
        ('time,"x\ry"\n0,1\n1,2\n2,3\n', r'is recognised \(time, x y\)'),
        ('time,"x\ry",z"\r0,"1,2\n1,2,3\n2,3,4\n', 'have another number of cells'),
    ],
)
def test_a_carriage_return_within_a_line_is_a_space(tmp_path, text, sentence):
    (tmp_path / 'log.csv').write_bytes(text.encode())
    with pytest.raises(BadInput, match=sentence):
        draft_mapping(tmp_path / 'log.csv', {})


def list_parts(path, answers):
    """Return the parts of each topic of a draft, by topic."""
    topics = yaml.safe_load(draft_mapping(path, answers).text)['topics']
    return {one.pop('topic'): one for one in topics}


def list_pose():
    f = lab_flight()
    return f, {'t': f['t'], **three('p', f['p']), **three('q', f['q'], 'xyzw')}


@pytest.mark.parametrize('word', ['std', 'stddev', 'sigma', 'uncertainty', 'cov', 'variance'])
def test_how_well_a_velocity_is_known_is_no_velocity(tmp_path, word):
    f, columns = list_pose()
    noise = 0.1 + 0.01 * np.random.default_rng(1).random((len(f['t']), 3))
    path = write_csv(tmp_path / 'a.csv', columns | three(f'vel_{word}_', noise))
    assert 'velocity' not in list_parts(path, {})['ground_truth/odom']


def test_speeds_to_the_front_and_the_side_are_those_of_the_body(tmp_path):
    f, columns = list_pose()
    names = ('front_speed', 'side_speed', 'up_speed')
    speeds = dict(zip(names, f['v'].T, strict=True))
    parts = list_parts(write_csv(tmp_path / 'a.csv', columns | speeds), {})
    assert parts['ground_truth/odom']['velocity'] == {'columns': [*names], 'unit': 'm/s'}
    assert [*parts] == ['ground_truth/odom']
    del speeds['up_speed']
    assert [*list_parts(write_csv(tmp_path / 'b.csv', columns | speeds), {})] == [
        'ground_truth/odom'
    ]


def test_speeds_to_the_front_and_the_rear_are_those_of_rotors(tmp_path):
    f, columns = list_pose()
    rotors = {f'{place}_speed': 300.0 + 10.0 * np.sin(f['t']) for place in ('front', 'rear')}
    parts = list_parts(write_csv(tmp_path / 'a.csv', columns | rotors), {})
    assert [*parts['motors']['actuators']] == ['front', 'rear']


def test_the_frame_of_a_second_velocity_is_as_the_user_says(tmp_path):
    f, columns = list_pose()
    own = three('est_v', f['v']) | three('est_p', f['p']) | three('est_q', f['q'], 'xyzw')
    path = write_csv(tmp_path / 'a.csv', columns | three('v', f['v']) | own)
    parts = list_parts(path, {'odom.velocity.frame': 'world'})
    assert 'frame' not in parts['ground_truth/odom']['velocity']
    assert parts['odom']['velocity']['frame'] == 'world'


def test_velocities_that_no_attitude_turns_are_named_with_the_reason(tmp_path):
    f = lab_flight()
    path = write_csv(tmp_path / 'a.csv', {'t': f['t'], **three('v', f['v'], 'ned')})
    with pytest.raises(BadInput, match=r'vn, ve, vd .* is left out: in world axes, and no att'):
        draft_mapping(path, {})


def test_times_that_repeat_are_times_also_if_the_last_one_is_cut(tmp_path):
    f, columns = list_pose()
    rows = np.arange(len(f['t'])) // 8 * 8  # of eight rows, the second has the time of the first
    times = np.where(np.arange(len(f['t'])) % 8 == 1, f['t'][rows], f['t'])
    table = {**columns, **three('v', f['v']), 'stamp_ns': np.round((times - times[0]) * 1e9)}
    path = write_csv(tmp_path / 'a.csv', {name: one for name, one in table.items() if name != 't'})
    path.write_bytes(path.read_bytes().rstrip()[:-6])
    assert 'time: {column: stamp_ns, unit: ns}' in draft_mapping(path, {}).text
