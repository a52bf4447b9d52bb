"""
The launch files under ROS 2's own `launch`, which the wheels do not have.

LTA_ROS_CHECKOUTS names a folder with checkouts of ros2/launch (3.4.3), ros2/launch_ros (0.26.6)
and osrf/osrf_pycommon, called launch, launch_ros and osrf_pycommon. Without it nothing is run.
"""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

import pytest

from .command import ROOT

CHECKOUTS = os.environ.get('LTA_ROS_CHECKOUTS', '')
PACKAGES = (
    'launch/launch',
    'launch/launch_xml',
    'launch/launch_yaml',
    'launch_ros/launch_ros',
    'osrf_pycommon',
)
FLY = ROOT / 'config/launch/fly.launch.yaml'
# What `ros2 launch FILE NAME:=VALUE ...` does once it has parsed its command line
LAUNCH = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
path, *words = sys.argv[1:]
service = LaunchService(argv=words)
source = AnyLaunchDescriptionSource(path)
pairs = [tuple(word.split(':=', 1)) for word in words]
service.include_launch_description(
    LaunchDescription([IncludeLaunchDescription(source, launch_arguments=pairs)])
)
sys.exit(service.run())
"""
NODES = (
    'simulator',
    'estimator',
    'controller',
    'demodulator',
    'navigator',
    'energy_monitor',
    'recorder',
)
pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not CHECKOUTS, reason='LTA_ROS_CHECKOUTS names no checkouts of ROS 2'),
]


@pytest.fixture(scope='module')
def prefix(tmp_path_factory):
    """Install the checkouts into a folder of their own; ROS 2's launch needs no compiler."""
    folder = tmp_path_factory.mktemp('ros')
    pip = [sys.executable, '-m', 'pip', 'install', '--quiet', '--disable-pip-version-check']
    alone = ['--no-deps', '--no-build-isolation', '--no-index', '--ignore-installed']
    paths = [str(Path(CHECKOUTS) / package) for package in PACKAGES]
    subprocess.run([*pip, *alone, '--prefix', folder, *paths], check=True)
    (site,) = folder.glob('lib/python*/site-packages')
    # launch_ros imports these for composable nodes, of which we have none
    (site / 'composition_interfaces').mkdir()
    (site / 'composition_interfaces/__init__.py').touch()
    (site / 'composition_interfaces/srv.py').write_text(
        'class LoadNode:\n    class Request: pass\n    class Response: pass\n'
    )
    # Its name for the standard library's importlib.metadata
    (site / 'importlib_metadata.py').write_text('from importlib.metadata import *\n')
    return folder, site


@pytest.fixture
def ros2_launch(lta, prefix):
    """Return a function that starts a launch file."""
    folder, site = prefix

    def start(*words):
        return lta.start(
            *words,
            program=(sys.executable, '-c', LAUNCH),
            PYTHONPATH=f'{site}:{os.environ.get("PYTHONPATH", "")}',
            AMENT_PREFIX_PATH=f'{folder}:{os.environ["AMENT_PREFIX_PATH"]}',
        )

    return start


@pytest.mark.parametrize('mode', ['lockstep', 'realtime'])
@pytest.mark.parametrize('name', NODES)
def test_a_killed_node_is_named_and_ends_the_run(
    ros2_launch, flying, scenario, tmp_path, mode, name
):
    room = scenario(radius='0.01 m', time_limit='600 s')
    run = ros2_launch(FLY, f'time:={mode}', f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    flying(0.5)
    os.kill(run.node(name), signal.SIGKILL)
    killed = time.monotonic()
    named = run.said(f'{name} was killed by SIGKILL, which ends the run.')
    assert run.end() == 1
    assert named - killed < 1.0
    assert time.monotonic() - killed < 10.0
    assert 'Traceback' not in run.text


@pytest.mark.parametrize('name', ['fly', 'pair'])
def test_a_flight_to_its_end_is_status_0(ros2_launch, scenario, tmp_path, name):
    room = scenario(time_limit='2 s')
    words = ('time:=lockstep', f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    run = ros2_launch(ROOT / f'config/launch/{name}.launch.yaml', *words)
    assert run.end() == 0, run.text
    assert (tmp_path / 'bag/metadata.yaml').exists()


@pytest.mark.parametrize(
    ('word', 'sentence'),
    [
        ('vehicle:=nope', "Unknown vehicle 'nope'; known: beavis"),
        ('seed:=x', 'The seed is x, but must be a whole number'),
        ('strateg:=bag', "Unknown launch argument 'strateg'"),
        ('strategy:=up', 'Argument "strategy" provided value "up" is not valid.'),
    ],
)
def test_a_wrong_argument_is_one_sentence_and_starts_nothing(ros2_launch, word, sentence):
    run = ros2_launch(FLY, word)
    assert run.end() == 1
    (line,) = [line for line in run.text.splitlines() if 'Caught exception' in line]
    assert sentence in line
    assert 'process started' not in run.text


def test_a_program_of_an_including_file_may_end(ros2_launch, scenario, tmp_path):
    room = scenario(time_limit='2 s')
    path = tmp_path / 'lab.launch.yaml'
    path.write_text(
        f'launch:\n  - include: {{file: {FLY}}}\n  - executable: {{cmd: "true"}}\n', 'utf-8'
    )
    run = ros2_launch(path, 'time:=lockstep', f'scenario:={room}', f'bag:={tmp_path / "bag"}')
    assert run.end() == 0, run.text
    assert (tmp_path / 'bag/metadata.yaml').exists()
