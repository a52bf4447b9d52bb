# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""`lta discover` from bags to its folder of results, and what it refuses."""

import json
from pathlib import Path
import subprocess

from lta_discovery.demo import DemoEffect, fly_hidden
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import load_vehicle
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
    told = json.loads(done.stdout)
    assert told['verdict'].startswith('named')
    (one,) = told['effects']
    assert one['knobs'] == ['linear_drag.surge']
    surge = one['parameters']['surge']
    assert surge['ci95'][0] - 0.001 < HIDDEN.value < surge['ci95'][1] + 0.001
    assert told['held_out'] is False
    far = [gap for gap in told['gaps'] if gap['channel'] == 'position'][-1]
    assert far['after'] < 0.5 * far['before']
    assert 'linear drag (surge)' in Path(told['page']).read_text()
    learned = load_vehicle(str(out / 'vehicle.yaml'))
    value = NominalVehicle.from_vehicle(learned).parameter_value('linear_drag', 'surge')
    assert value == pytest.approx(surge['value'], rel=1e-9)


@pytest.mark.long  # the test before has all that it does, but for the flights of its own
def test_the_demonstration_names_what_it_has_hidden(tmp_path):
    out = tmp_path / 'demo'
    words = [ROOT / 'lta', 'discover', '--demo', '--out', out]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stderr
    told = json.loads((out / 'discovery.json').read_text())
    assert told['verdict'].startswith('named')
    assert [told['hidden']['name']] in [one['knobs'] for one in told['effects']]
    far = next(gap for gap in told['gaps'] if gap['horizon_s'] == 3.0)
    assert far['before'] >= 4.0 * far['after']
    assert told['hidden']['name'].partition('.')[0] in (out / 'vehicle.yaml').read_text()
