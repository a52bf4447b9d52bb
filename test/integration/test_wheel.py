# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The wheel of all that needs no ROS graph, tried in an environment that has nothing else."""

from contextlib import ExitStack
import json
from pathlib import Path
import shutil
import subprocess
import sys

from distributed import Client
from doc_blocks import blocks
from lta_config.version import VERSION
from ports import free_port
import pytest
from waiting import PATIENCE

ROOT = Path(__file__).resolve().parents[2]
README_PYTHON = ('README.md', 'python')
SWEEP = """schema: 1
name: two
about: Two flights.
vehicle: gtmab
scenario: lamp_room
strategy: bag
gains: gtmab
seeds: {first: 1, count: 1}
vary:
  vehicle.trim.heaviness: [2 g, 4 g]
"""


@pytest.mark.long
def test_the_wheel_in_an_empty_environment(tmp_path):
    built = subprocess.run([ROOT / 'tools/wheel.sh', tmp_path], capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    (wheel,) = tmp_path.glob('lta-*.whl')
    venv = tmp_path / 'venv'
    subprocess.run([sys.executable, '-m', 'venv', venv], check=True)

    def install(extras):
        pip = [venv / 'bin/pip', 'install', '--quiet', '--constraint', ROOT / 'constraints.txt']
        done = subprocess.run([*pip, f'{wheel}{extras}'], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[-2000:]

    install('')

    def lta(*words, status=0):
        clean = {'HOME': str(tmp_path), 'PATH': f'{venv}/bin:/usr/bin:/bin'}
        done = subprocess.run(
            [venv / 'bin/lta', *words], cwd=tmp_path, env=clean, capture_output=True, text=True
        )
        assert done.returncode == status, done.stderr[-2000:]
        return done

    assert lta('--version').stdout == f'lta {VERSION}\n'
    assert 'launch ' not in lta('--help').stdout.partition('Results go to')[0]
    assert lta('doctor', '--json').stdout
    study_flights(lta, venv, tmp_path)
    (tmp_path / 'two.yaml').write_text(SWEEP)
    swept = json.loads(lta('sweep', 'two.yaml', '--no-page', '--json').stdout)
    assert Path(tmp_path, swept['table']).is_file()
    address = f'udp://127.0.0.1:{free_port()}'
    lacking = {
        'distributed': ('sweep', 'two.yaml', '--scheduler', 'tcp://127.0.0.1:1'),
        'cflib': ('hardware', 'check', '--uri', address),
        'imageio-ffmpeg': ('report', 'flown', '--video', 'flight.gif'),
    }
    for package, words in lacking.items():
        assert f'pip install {package}' in lta(*words, status=2).stderr
    install('[notebook,hardware,dask,video]')
    # README's lines of Python, after the flights that `study_flights` flew
    (lines,) = (block.text for block in blocks() if (block.page, block.language) == README_PYTHON)
    (tmp_path / 'runs').mkdir(exist_ok=True)
    (tmp_path / 'flown').rename(tmp_path / 'runs/flown')
    subprocess.run([venv / 'bin/python', '-P', '-c', lines], cwd=tmp_path, check=True)
    assert (tmp_path / 'runs/height.html').is_file()
    (tmp_path / 'runs/flown').rename(tmp_path / 'flown')
    lta(*lacking['imageio-ffmpeg'])
    assert 'pip install' not in lta(*lacking['cflib'], status=1).stderr
    assert fly_on_cluster(venv, lta, tmp_path) == swept['outcomes']
    (tmp_path / 'examples').mkdir()  # a notebook writes into runs/ beside its folder
    book = shutil.copy(ROOT / 'examples/first_flight.ipynb', tmp_path / 'examples')
    subprocess.run([venv / 'bin/jupyter', 'execute', book], check=True)
    log = tmp_path / 'log.csv'
    log.write_text('# timestamp tx ty tz qx qy qz qw\n1.0 0 0 1 0 0 0 1\n2.0 1 0 1 0 0 0 1\n')
    lta('import', log.name, '--mapping', 'tum', '--out', 'imported')
    assert '2 messages' in lta('bag', 'info', 'imported').stdout
    for words in (('fly',), ('replay', 'imported'), ('launch', 'fly'), ('call', 'sim/reset')):
        refused = lta(*words, status=2).stderr
        assert 'needs ROS 2' in refused
        assert len(refused.splitlines()) == 1


def study_flights(lta, venv, folder):
    """Simulate with a bag, and use it as a user would."""
    flown = json.loads(lta('simulate', '--out', 'flown', '--json').stdout)
    assert flown['outcome'] == 'reached'
    assert (folder / 'flown/report.html').is_file()
    assert 'clean' in lta('bag', 'check', 'flown').stdout
    script = """
import lta_analysis
odom = lta_analysis.simulate(seed=2, out='again')['odom']
assert abs(odom.loc[5.0:9.0, 'pose.pose.position.z'].mean() - 0.5) < 0.05
"""
    subprocess.run([venv / 'bin/python', '-P', '-c', script], cwd=folder, check=True)
    lta('compare', 'flown', 'again', '--out', 'compared')
    words = ('--vehicle', 'gtmab', '--train', 'flown', 'again', '--out')
    lta('calibrate', *words, 'calibrated')
    lta('discover', *words, 'discovered')


def fly_on_cluster(venv, lta, folder):
    """Fly the sweep on workers that the wheel alone has started; return the outcomes."""
    address = f'tcp://127.0.0.1:{free_port()}'
    clean = {'HOME': str(folder), 'PATH': f'{venv}/bin:/usr/bin:/bin'}
    commands = (
        ('dask', 'scheduler', '--host', '127.0.0.1', '--port', address.rpartition(':')[2]),
        ('dask', 'worker', address, '--nworkers', '2', '--nthreads', '1', '--no-dashboard'),
    )
    with ExitStack() as running:
        for program, *words in commands:
            process = running.enter_context(subprocess.Popen(
                [venv / 'bin' / program, *words], env=clean, stderr=subprocess.DEVNULL
            ))  # fmt: skip
            running.callback(process.terminate)
        client = running.enter_context(Client(address, timeout=PATIENCE, set_as_default=False))
        client.wait_for_workers(2, timeout=PATIENCE)
        words = ('--out', 'far', '--scheduler', address, '--no-page', '--json')
        return json.loads(lta('sweep', 'two.yaml', *words).stdout)['outcomes']
