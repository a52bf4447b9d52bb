# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The workspace as `colcon build` installs it: copied, not linked, and started as `ros2 run` would.

Whatever executables the packages declare are found here by themselves: nothing to add for a node.
"""

import ast
from collections.abc import Iterator
import json
import os
from pathlib import Path
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

from diagnostic_msgs.msg import DiagnosticArray
from lta_graph.child_process import build_node_environment as node_environment
from lta_graph.launches import FLY, LAUNCHES
from ports import free_port
import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from signals import heed_signals

ROOT = Path(__file__).resolve().parents[2]
START = 120.0  # s; a cold start on a busy machine, with the kernel to compile
REPORTS = 2  # by a timer, after which all that a node has before any message comes has fired
WAITING = ('player', 'simulator')  # for others first, without a timer: to be there is all they do
STOP = 120.0  # s from SIGINT to the end, on a machine that others use as well
NAMESPACE = '/probe'
PACKAGES = {'lta_config', *(path.parent.name for path in ROOT.glob('src/*/setup.py'))}
CARRIED = {  # what a drone's own computer needs
    'lta_bag',
    'lta_bridge',
    'lta_config',
    'lta_control',
    'lta_energy',
    'lta_graph',
    'lta_model',
    'lta_vlc',
}
# Start all of a launch file but the simulator; stop it when the other end closes the pipe.
DRONE = """
from dataclasses import replace
from importlib.util import find_spec
import json
import sys

from lta_graph.launcher import Launcher
from lta_graph.launches import FLY, LAUNCHES

assert find_spec('lta_sim') is None
plan = FLY.build_plan(json.loads(sys.argv[1]))
aboard = tuple(process for process in plan.processes if process.package != 'lta_sim')
with Launcher(replace(plan, processes=aboard), lambda _name, _line: None) as launcher:
    sys.stdin.read()
print(json.dumps([[end.name, end.status, *end.lines] for end in launcher.ended]))
"""


def ignore_what_git_ignores(folder: str, names: list[str]) -> set[str]:
    """Return the names that a clone of the repository would not have."""
    made = {'build', 'dist', 'install', 'log', 'runs', 'site'} if Path(folder) == ROOT else set()
    return {name for name in names if name in made or name.startswith('.') or is_made(name)}


def is_made(name: str) -> bool:
    """Return whether a run leaves files of this name everywhere."""
    return name == '__pycache__' or name.endswith('.egg-info')


@pytest.fixture(scope='module')
def installed(tmp_path_factory) -> Path:
    """
    Return an install folder that `colcon build` makes of a workspace with the repository in src/.

    The environment of make is the underlay: it has lta_msgs, which colcon builds with ament_cmake.
    """
    folder = tmp_path_factory.mktemp('workspace')
    repository = folder / 'src/lta'
    shutil.copytree(ROOT, repository, ignore=ignore_what_git_ignores)
    (repository / 'src/lta_msgs/COLCON_IGNORE').touch()
    (folder / 'colcon.meta').symlink_to('src/lta/colcon.meta')
    environment = {key: value for key, value in os.environ.items() if key != 'PYTHONPATH'}
    environment |= {'AMENT_PREFIX_PATH': sys.prefix, 'VIRTUAL_ENV': sys.prefix}
    result = subprocess.run(
        [Path(sys.prefix) / 'bin' / 'colcon', 'build'],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=300,
    )
    assert result.returncode == 0, result.stdout
    assert 'WARNING' not in result.stdout
    built = re.findall(r'Finished <<< (\w+)', result.stdout)
    assert sorted(built) == sorted(PACKAGES)
    # Links into the sources would hide what setup.py forgets to install.
    shutil.rmtree(repository)
    return folder / 'install'


@pytest.fixture(scope='module')
def environment(installed) -> dict[str, str]:
    """Return the environment that the setup script of the installation makes."""
    base = {key: os.environ[key] for key in ('PATH', 'HOME', 'LANG') if key in os.environ}
    script = f'. {installed}/local_setup.sh && env -0'
    # The environment of make is the underlay, as a sourced ROS would be.
    base['AMENT_PREFIX_PATH'] = sys.prefix
    output = subprocess.run(['sh', '-c', script], env=base, capture_output=True, check=True).stdout
    made = dict(item.split('=', 1) for item in output.decode().split('\0') if item)
    return made | {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'OPENBLAS_NUM_THREADS': '1'}


class Watcher:
    """A node that sees who is in its domain, and hears them report."""

    def __init__(self, domain_id: int) -> None:
        self._context = Context()
        rclpy.init(context=self._context, domain_id=domain_id)
        self._node = Node('watcher', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._reports: list[DiagnosticArray] = []
        self._node.create_subscription(DiagnosticArray, '/diagnostics', self._reports.append, 10)

    def settled(self, name: str) -> bool:
        """Listen a moment; tell whether a node is there that has reported as it does for ever."""
        self._executor.spin_once(timeout_sec=0.05)
        there = (name, NAMESPACE) in self._node.get_node_names_and_namespaces()
        return there and (name in WAITING or len(self._reports) >= REPORTS)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()


@pytest.fixture
def watcher(domain_id) -> Iterator[Watcher]:
    """Return a watcher of this test's domain, in which nobody else reports."""
    made = Watcher(domain_id)
    yield made
    made.close()


def declared() -> list[tuple[str, str]]:
    """Return (package, executable) of every console script in the sources."""
    found = []
    for setup in (ROOT / 'config' / 'setup.py', *sorted(ROOT.glob('src/*/setup.py'))):
        package = 'lta_config' if setup.parent == ROOT / 'config' else setup.parent.name
        tree = ast.parse(setup.read_text(encoding='utf-8'))
        (points,) = (
            ast.literal_eval(node.value)
            for node in ast.walk(tree)
            if isinstance(node, ast.keyword) and node.arg == 'entry_points'
        )
        names = [text.split(' = ')[0] for text in points['console_scripts']]
        found += [(package, name) for name in names]
    return found


NEEDS = {  # without which it refuses
    'player': ('-p', f'bag:={ROOT / "test/replay/lamp.mcap"}'),
    'teensy_bridge': ('-p', 'autostart:=false'),
}
# The command, the drone at the other end of a link, and what runs several nodes, are no nodes.
OTHERS = {
    ('lta_cli', 'lta'),
    ('lta_analysis', 'lta'),
    ('lta_emulation', 'emulated_hardware'),
    ('lta_graph', 'one_process'),
}
QUICK = ('controller', 'player')  # the others start alike
NODES = [
    pytest.param(*pair, marks=() if pair[1] in QUICK else pytest.mark.long)
    for pair in declared()
    if pair not in OTHERS
]


def test_every_package_is_in_the_ament_index(installed):
    for name in PACKAGES:
        marker = installed / name / 'share/ament_index/resource_index/packages' / name
        assert marker.is_file(), name
        assert (installed / name / 'share' / name / 'package.xml').is_file(), name


def test_what_is_declared_is_what_is_installed(installed):
    executables = [path for path in installed.glob('*/lib/*/*') if os.access(path, os.X_OK)]
    # Beside them lies <prefix>/lib/python3.x, with no executables directly in it.
    found = {(path.parent.name, path.name) for path in executables if path.is_file()}
    assert found == set(declared())


def test_data_is_installed_with_lta_config(installed):
    share = installed / 'lta_config' / 'share' / 'lta_config'
    kinds = ('.yaml', '.json', '.csv', '.npz', '.xml', '.rviz')
    expected = {
        path.relative_to(ROOT / 'config')
        for path in (ROOT / 'config').rglob('*')
        if path.suffix in kinds and path.name != 'package.xml'
    }
    assert Path('topics.yaml') in expected
    missing = {str(path) for path in expected if not (share / path).is_file()}
    assert not missing, 'config/setup.py does not install these'
    launches = installed / 'lta_bringup' / 'share' / 'lta_bringup' / 'launch'
    assert {path.name for path in launches.iterdir()} == {f'{name}.launch.py' for name in LAUNCHES}


@pytest.mark.parametrize(('package', 'executable'), NODES)
def test_node_starts_and_stops(package, executable, installed, environment, watcher, tmp_path):
    command = [installed / package / 'lib' / package / executable]
    command += ['--ros-args', '-r', f'__ns:={NAMESPACE}', *NEEDS.get(executable, ())]
    if executable == 'live':  # somebody may be looking at another graph of this machine
        command += ['-p', f'port:={free_port()}']
    environment = environment | {'ROS_DOMAIN_ID': os.environ['ROS_DOMAIN_ID']}
    log = tmp_path / 'log'
    with log.open('wb') as output:
        process = subprocess.Popen(
            command, cwd=tmp_path, env=environment, stdout=output, stderr=subprocess.STDOUT
        )
    try:
        deadline = time.monotonic() + START
        while not watcher.settled(executable):
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < deadline, f'it does not report; {log.read_text()}'
        assert process.poll() is None, log.read_text()
        process.send_signal(signal.SIGINT)
        # 130: it was in the graph, and still waiting for others.
        left = (0, 128 + signal.SIGINT) if executable in WAITING else (0,)
        assert process.wait(STOP) in left, log.read_text()
    finally:
        process.kill()
        process.wait()
    assert 'Traceback' not in log.read_text()


INTERRUPTED = """
import os, signal
os.kill(os.getpid(), signal.SIGINT)
raise ImportError('the import went on')
"""
EXECUTABLES = [
    pytest.param(*pair, marks=() if pair[1] in QUICK else pytest.mark.long)
    for pair in declared()
    if pair[1] != 'lta'  # test_command.py
]


@pytest.mark.parametrize(('package', 'executable'), EXECUTABLES)
def test_ctrl_c_during_the_imports_is_answered_without_a_traceback(
    package, executable, installed, environment, tmp_path
):
    (tmp_path / 'lta_config.py').write_text(INTERRUPTED, encoding='utf-8')  # which all import
    path = f'{tmp_path}:{environment["PYTHONPATH"]}'
    command = [installed / package / 'lib' / package / executable]
    done = subprocess.run(
        command, cwd=tmp_path, env=environment | {'PYTHONPATH': path}, capture_output=True,
        text=True, timeout=START, check=False, preexec_fn=heed_signals,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (128 + signal.SIGINT, '', '')


def test_a_node_names_the_limit_of_memory_that_keeps_a_library_from_loading(
    installed, environment, tmp_path
):
    library = "raise ImportError('librcl.so: failed to map segment from shared object')"
    (tmp_path / 'rclpy.py').write_text(library, encoding='utf-8')
    path = f'{tmp_path}:{environment["PYTHONPATH"]}'
    done = subprocess.run(
        [installed / 'lta_control/lib/lta_control/controller'], cwd=tmp_path,
        env=environment | {'PYTHONPATH': path}, capture_output=True, text=True, timeout=START,
        check=False, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (3 << 30,) * 2),
    )  # fmt: skip
    assert done.returncode == 2, done.stderr
    assert done.stderr == (
        'The command failed with a limit of 3072 MB of memory (ImportError: librcl.so: failed to '
        'map segment from shared object); raise it with `ulimit -v 4194304`, in a new shell if '
        'that is refused.\n'
    )


HELP = [
    *(pytest.param(*each.values, '--help', marks=each.marks) for each in EXECUTABLES),
    ('lta_control', 'controller', '-h'),
    ('lta_control', 'controller', '--ros-args --help'),
]


@pytest.mark.parametrize(('package', 'executable', 'words'), HELP)
def test_an_executable_explains_itself(
    package, executable, words, installed, environment, tmp_path
):
    command = [installed / package / 'lib' / package / executable, *words.split()]
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=START,
        check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, '')
    assert 'usage: ' in done.stdout.lower()
    assert executable in done.stdout
    assert list(tmp_path.iterdir()) == []


def test_the_ros2_command_says_how_to_install_it(tmp_path):
    command = shutil.copy(Path(__file__).resolve().parents[2] / 'ros2', tmp_path)
    done = subprocess.run([command, 'topic', 'list'], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == f"The ros2 command is not installed; run 'make ros2' in {tmp_path}.\n"


def carried(environment: dict[str, str], installed: Path) -> dict[str, str]:
    """Return an environment in which only the packages of a drone's computer are found."""
    kept = dict(environment)
    for name in ('PYTHONPATH', 'AMENT_PREFIX_PATH'):
        kept[name] = os.pathsep.join(
            path
            for path in environment[name].split(os.pathsep)
            if not Path(path).is_relative_to(installed)
            or Path(path).relative_to(installed).parts[0] in CARRIED
        )
    return kept


def test_a_drone_s_computer_needs_no_simulator(installed, environment, domain_id, tmp_path):
    given = {'time': 'lockstep', 'bag': str(tmp_path / 'bag'), 'seed': '2'}
    (world,) = (one for one in FLY.build_plan(given).processes if one.package == 'lta_sim')
    executable = installed / world.package / 'lib' / world.package / world.executable
    everywhere = {'ROS_DOMAIN_ID': str(domain_id), **node_environment()} | environment
    words = [sys.executable, '-c', DRONE, json.dumps(given)]
    with subprocess.Popen(
        words, cwd=tmp_path, env=carried(everywhere, installed), text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
    ) as drone:  # fmt: skip
        flight = subprocess.run(
            [executable, *world.arguments], cwd=tmp_path, env=everywhere, text=True,
            capture_output=True, timeout=START, check=False,
        )  # fmt: skip
        ended = json.loads(drone.communicate(timeout=STOP)[0].splitlines()[-1])
    assert flight.returncode == 0, flight.stderr
    assert json.loads(flight.stdout.splitlines()[-1])['outcome'] == 'reached'
    nodes = {'controller', 'demodulator', 'energy_monitor', 'estimator', 'navigator', 'recorder'}
    assert {name for name, *_ in ended} == nodes | {'description'}
    assert all(status == 0 for _, status, *_ in ended), ended
