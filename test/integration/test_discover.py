"""`lta discover` from bags to its folder of results, and what it refuses."""

import json
from pathlib import Path
import re
import subprocess

from lta_cli.app import run_command_line
from lta_discovery.demo.hidden_effect import DemoEffect, fly_hidden
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import load_vehicle
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
import pytest

HIDDEN = DemoEffect('linear_drag.surge', 0.04, 'N s/m')
SECONDS = 26.0
PATIENCE = 600.0  # s of wall time; alone on a machine it takes ten
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope='module')
def bags(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two flights with more drag than the vehicle file says."""
    folder = tmp_path_factory.mktemp('bags')
    a, b = (fly_hidden(HIDDEN, 60 + k, SECONDS, folder / name) for k, name in enumerate('AB'))
    return a, b


def test_a_hidden_effect_is_found_added_and_shown(bags, tmp_path):
    a, b = bags
    out = tmp_path / 'found'
    words = ['--vehicle', 'gtmab', '--train', a, '--confirm', b, '--out', out, '--json']
    done = subprocess.run(
        [ROOT / 'lta', 'discover', *words], capture_output=True, text=True, timeout=PATIENCE
    )
    assert done.returncode == 0, done.stderr
    # A slow machine is told how far it is
    assert all(line.endswith('...') for line in done.stderr.splitlines())
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
    value = NominalVehicle.from_vehicle(learned).parameter_value('linear_drag', 'surge')
    assert value == pytest.approx(surge['value'], rel=1e-9)
    _is_overlay(out / 'overlay.mcap')
    assert (out / 'animation.svg').read_text().startswith('<svg')


@pytest.mark.long  # the test before has all that it does, but for the flights of its own
def test_the_demonstration_names_what_it_has_hidden(tmp_path):
    out = tmp_path / 'demo'
    words = [ROOT / 'lta', 'discover', '--demo', '--out', out]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    hidden, _, found, _ = re.search(
        r'^Hidden: (\S+) = (.*)\. Result: (\S+) = (.*)\.$', done.stdout, re.MULTILINE
    ).groups()
    assert found == hidden
    told = json.loads((out / 'discovery.json').read_text())
    assert (told['verdict'], told['conclusion']['asserted']) == ('named', True)
    gap = told['gap']
    assert gap['before'] >= 5.0 * gap['after']
    assert gap['tuned'] >= 2.0 * gap['after']
    assert hidden.partition('.')[0] in (out / 'vehicle.yaml').read_text()


def _is_overlay(path):
    """Check the bag of measured and predicted poses with a reader of somebody else's."""
    seen = {}
    with path.open('rb') as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, content in reader.iter_decoded_messages():
            seen.setdefault(channel.topic, {})[message.log_time] = content
    assert set(seen) == {
        f'/B/{kind}' for kind in ('measured', 'before', 'after', 'before/error', 'after/error')
    }  # fmt: skip
    sizes = {}
    for kind in ('before', 'after'):
        vectors = [one.vector for one in seen[f'/B/{kind}/error'].values()]
        sizes[kind] = sum(v.x**2 + v.y**2 + v.z**2 for v in vectors) / len(vectors)
    assert sizes['after'] < 0.3 * sizes['before']
    for time, off in seen['/B/after/error'].items():
        a, b = (seen[f'/B/{kind}'][time].pose.pose.position for kind in ('after', 'measured'))
        assert off.vector.x == pytest.approx(a.x - b.x)


@pytest.mark.parametrize(
    ('words', 'said'),
    [
        (('--train', 'A', '--confirm', 'B'), 'A vehicle file to compare'),
        (('--vehicle', 'gtmab'), 'no training flight'),
        (('--vehicle', 'gtmab', '--train', 'A', 'B', '--confirm', 'A'), 'is given twice'),
        (('--vehicle', 'sblimp', '--train', 'A', '--confirm', 'B'), 'has no commands for'),
        (('--demo', '--train', 'A'), '--demo simulates its own flights'),
    ],
)
def test_what_cannot_be_studied_is_one_sentence(bags, words, said, tmp_path, monkeypatch, capsys):
    paths = {bag.name: str(bag) for bag in bags}
    told = [paths.get(word, word) for word in words]
    monkeypatch.setattr('sys.argv', ['lta', 'discover', *told, '--out', str(tmp_path / 'none')])
    assert run_command_line() == 2
    heard = capsys.readouterr().err
    assert said in heard
    assert heard.count('\n') == 1
    assert not (tmp_path / 'none').exists()
