"""`lta discover` from bags to its folder of results, and what it refuses."""

import json
from pathlib import Path

from lta_analysis.discovery.hidden import fly_hidden, Hidden
from lta_analysis.discovery.nominal import Nominal
from lta_sim.vehicle import load_vehicle
from mcap_ros2.reader import read_ros2_messages
import pytest

HIDDEN = Hidden('linear_drag.surge', 0.04, 'N s/m')
SECONDS = 32.0


@pytest.fixture(scope='module')
def bags(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two flights with more drag than the vehicle file says."""
    folder = tmp_path_factory.mktemp('bags')
    a, b = (fly_hidden(HIDDEN, 60 + k, SECONDS, folder / name) for k, name in enumerate('AB'))
    return a, b


def test_a_hidden_effect_is_found_added_and_shown(lta, bags, tmp_path):
    a, b = bags
    out = tmp_path / 'found'
    done = lta.run('discover', '--vehicle', 'gtmab', '--train', a, '--confirm', b, '--out', out,
                   '--json')  # fmt: skip
    assert (done.returncode, done.stderr) == (0, '')
    told = json.loads(done.stdout)
    assert told['verdict'].startswith('named')
    (effect,) = told['effects']
    surge = effect['parameters']['surge']
    assert effect['name'] == 'linear_drag'
    assert surge['ci95'][0] - 0.001 < HIDDEN.value < surge['ci95'][1] + 0.001
    assert told['gap']['after'] < 0.5 * told['gap']['before']
    assert told['gap']['held_out'] is False
    assert 'surge' in {place['channel'] for place in told['where']}
    assert json.loads((out / 'discovery.json').read_text()) | {'page': told['page']} == told
    assert Path(told['page']).read_text().count('linear drag (surge)') > 0
    learned = load_vehicle(str(out / 'vehicle.yaml'))
    value = Nominal.of(learned).value('linear_drag', 'surge')
    assert value == pytest.approx(surge['value'], rel=1e-9)
    _is_overlay(out / 'overlay.mcap')


def _is_overlay(path):
    """Check the bag of measured and predicted poses with a reader of somebody else's."""
    seen = {}
    for message in read_ros2_messages(path):
        seen.setdefault(message.channel.topic, []).append(message)
    assert set(seen) == {
        f'/B/{kind}' for kind in ('measured', 'before', 'after', 'before/error', 'after/error')
    }  # fmt: skip
    measured = {one.log_time_ns: one.ros_msg.pose.pose.position for one in seen['/B/measured']}
    predicted = {one.log_time_ns: one.ros_msg.pose.pose.position for one in seen['/B/after']}
    sizes = {}
    for kind in ('before', 'after'):
        vectors = {one.log_time_ns: one.ros_msg.vector for one in seen[f'/B/{kind}/error']}
        sizes[kind] = sum(v.x**2 + v.y**2 + v.z**2 for v in vectors.values()) / len(vectors)
    assert sizes['after'] < 0.3 * sizes['before']
    for time, vector in vectors.items():
        assert vector.x == pytest.approx(predicted[time].x - measured[time].x)


def test_what_cannot_be_studied_is_one_sentence(lta, bags, tmp_path):
    a, b = bags
    for words, said in (
        (('--train', a, '--confirm', b), 'no vehicle file'),
        (('--vehicle', 'gtmab'), 'no flight to learn from'),
        (('--vehicle', 'gtmab', '--train', a, b, '--confirm', a), 'is given twice'),
        (('--vehicle', 'sblimp', '--train', a, '--confirm', b), 'has no command of'),
        (('--demo', '--train', a), '--demo flies flights of its own'),
    ):
        done = lta.run('discover', *words, '--out', tmp_path / 'none')
        assert done.returncode == 2
        assert said in done.stderr
        assert done.stderr.count('\n') == 1
        assert 'Traceback' not in done.stderr
    assert not (tmp_path / 'none').exists()
