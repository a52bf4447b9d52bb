# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Every package says of itself what is true: name, version, dependencies, executables, fence."""

import ast
from collections import Counter
from functools import cache
from importlib import import_module
from itertools import accumulate
from pathlib import Path
import re
import runpy
import sys

from catkin_pkg.package import parse_package
from lta_cli.doctor.machine import check_python_version
from lta_config.version import VERSION
from lta_graph.launches import DRONE_NODES
import package_tests
import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
FIRST_FLIGHT = 'docs/tutorials/first_flight.md'
FOLDERS = [ROOT / 'config', *sorted(path.parent for path in ROOT.glob('src/*/setup.py'))]
NAMES = {
    'lta_analysis',
    'lta_bag',
    'lta_bridge',
    'lta_bringup',
    'lta_cli',
    'lta_config',
    'lta_control',
    'lta_data',
    'lta_discovery',
    'lta_emulation',
    'lta_energy',
    'lta_flight',
    'lta_graph',
    'lta_model',
    'lta_report',
    'lta_sim',
    'lta_studies',
    'lta_vehicle',
    'lta_vlc',
    'lta_windtunnel',
}
# The key by which package.xml calls each module that is not of ROS. tools/rosdep.yaml has the
# rules of those that rosdistro lacks; Ubuntu's own packages of some are too old (pydantic).
ROSDEP = {
    'cflib': 'python3-cflib-pip',
    'cmaes': 'python3-cmaes-pip',
    'fastcrc': 'python3-fastcrc-pip',
    'foxglove': 'python3-foxglove-sdk-pip',
    'hypothesis': 'python3-hypothesis-pip',
    # Its program is Ubuntu's
    'imageio_ffmpeg': 'ffmpeg',
    'lz4': 'python3-lz4-pip',
    'mcap': 'python3-mcap-pip',
    'mcap_ros2': 'mcap-ros2-support',
    'numba': 'python3-numba-pip',
    'numpy': 'python3-numpy',
    'pandas': 'python3-pandas',
    'plotext': 'python3-plotext-pip',
    'plotly': 'python3-plotly-pip',
    'pyarrow': 'python3-pyarrow-pip',
    'pydantic': 'python3-pydantic-pip',
    'pymavlink': 'python3-pymavlink-pip',
    'pytest': 'python3-pytest-pip',
    'pyulog': 'python3-pyulog-pip',
    'rich': 'python3-rich',
    'rosbags': 'python3-rosbags-pip',
    'ruamel': 'python3-ruamel.yaml-pip',
    'scipy': 'python3-scipy',
    'serial': 'python3-serial',
    'trimesh': 'python3-trimesh-pip',
    'typer': 'python3-typer-pip',
    'yaml': 'python3-yaml',
    'zstandard': 'python3-zstandard-pip',
}
ROS = re.compile(
    r'(rclpy|launch|launch_ros|ament_index_python|builtin_interfaces|rcl_interfaces|\w+_msgs|std_srvs)$'
)
FENCED = re.compile(r'(rclpy|builtin_interfaces|rcl_interfaces|\w+_msgs|std_srvs)(\.|$)')
BEYOND = re.compile(r'lta_graph\.ros(\.|$)|lta_\w+\.(nodes|messages)(\.|$)')
CONDUCTORS = {  # start a graph and listen to it, record a flight as one, or ask what nodes take
    'src/lta_discovery/lta_discovery/demo.py',
    'src/lta_flight/lta_flight/flight.py',
    'src/lta_flight/lta_flight/graph.py',
    'src/lta_flight/lta_flight/replay/node_settings.py',
    'src/lta_flight/lta_flight/replay/run.py',
    'src/lta_flight/lta_flight/simulate.py',
    'src/lta_cli/lta_cli/verbs/call.py',
}

# What the launch files import and start, and what reads and checks them
STARTED = {entry.package for entry in DRONE_NODES} | {
    'lta_emulation',
    'lta_flight',
    'lta_graph',
    'ros2launch',
}
OPTIONAL = {'pvlib', 'pybamm'}  # what a test skips without
FOLDERS_OF_TESTS = {'campaigns', 'oracle', 'tools', 'vlc'}
HELPERS = {path.stem for path in (ROOT / 'test').rglob('*.py')} | FOLDERS_OF_TESTS | OPTIONAL
MODULES = 25  # of one folder
CODE = re.compile(r'(from [\w.]+ )?import [\w., ]+\n')  # a line of code that is written to a file

each_package = pytest.mark.parametrize('folder', FOLDERS, ids=lambda folder: folder.name)


def name_of(folder):
    return 'lta_config' if folder.name == 'config' else folder.name


def sources(folder):
    return sorted((folder / name_of(folder)).rglob('*.py'))


@cache
def imports(path):
    """Return the full names of all modules that a file imports, wherever in the file."""
    return imports_of(ast.parse(path.read_text(encoding='utf-8')))


def called(node):
    """Return the name of the called function, without the module before it."""
    return getattr(node.func, 'attr', getattr(node.func, 'id', ''))


def imports_of(tree):
    """Return what is imported: by statement, by import_module, and in the text of made code."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found |= {f'{node.module}.{alias.name}' for alias in node.names}
        elif isinstance(node, ast.Call) and called(node) == 'import_module':
            name = node.args[0]
            found |= {name.value} if isinstance(name, ast.Constant) else set()
        elif isinstance(node, ast.Constant) and CODE.fullmatch(str(node.value)):
            found |= imports_of(ast.parse(node.value))
    return found


def setup_of(folder):
    """Return the literal arguments of the setup() call."""
    calls = [
        node
        for node in ast.walk(ast.parse((folder / 'setup.py').read_text(encoding='utf-8')))
        if isinstance(node, ast.Call) and getattr(node.func, 'id', '') == 'setup'
    ]
    assert len(calls) == 1
    arguments = {}
    for keyword in calls[0].keywords:
        try:
            arguments[keyword.arg] = ast.literal_eval(keyword.value)
        except ValueError:
            continue  # data_files may be computed
    return arguments


def executables(folder):
    """Return (name, module, function) of each console script."""
    scripts = setup_of(folder)['entry_points']['console_scripts']
    return [re.fullmatch(r'(\w+) = ([\w.]+):(\w+)', script).groups() for script in scripts]


def inside_the_fence(path):
    """Return whether a file is a core, which knows no ROS."""
    within = path.relative_to(ROOT).parts
    return not (
        str(path.relative_to(ROOT)) in CONDUCTORS
        or 'nodes' in within
        or path.name == 'messages.py'
        or within[2:4] == ('lta_graph', 'ros')
    )


def test_the_workspace_has_these_packages():
    assert {name_of(folder) for folder in FOLDERS} == NAMES


@each_package
def test_manifest_is_valid_and_agrees_with_setup(folder):
    warnings = []
    manifest = parse_package(folder / 'package.xml', warnings=warnings)
    manifest.validate()
    setup = setup_of(folder)
    assert warnings == []
    assert manifest.package_format == 3
    assert manifest.get_build_type() == 'ament_python'
    assert manifest.name == setup['name'] == name_of(folder)
    assert manifest.version == setup['version']
    assert manifest.description == setup['description']
    assert manifest.licenses == [setup['license']] == ['Apache-2.0']
    assert [person.email for person in manifest.maintainers] == [setup['maintainer_email']]


def test_the_messages_are_declared_to_both_builds():
    """colcon on a full ROS reads CMakeLists.txt, `make build` the files beside it."""
    folder = ROOT / 'src/lta_msgs'
    warnings = []
    parse_package(folder / 'package.xml', warnings=warnings).validate()
    assert warnings == []
    listed = re.findall(r'"((?:msg|action)/.*)"', (folder / 'CMakeLists.txt').read_text())
    there = [path for kind in ('msg', 'action') for path in folder.glob(f'{kind}/*')]
    assert sorted(listed) == sorted(str(path.relative_to(folder)) for path in there)


@each_package
def test_installed_where_ros2_run_and_the_ament_index_look(folder):
    name = name_of(folder)
    assert (folder / 'resource' / name).read_bytes() == b''
    lines = (folder / 'setup.cfg').read_text().split()
    assert f'script_dir=$base/lib/{name}' in lines
    assert f'install_scripts=$base/lib/{name}' in lines
    assert (folder / name / 'py.typed').is_file() or not sources(folder)


@each_package
def test_executables_can_be_imported_and_every_node_is_one(folder):
    scripts = executables(folder)
    for name, module, function in scripts:
        assert callable(getattr(import_module(module), function)), name
    nodes = {path.stem for path in (folder / name_of(folder) / 'nodes').glob('[!_]*.py')}
    started = {module.rpartition('.')[2] for _, module, _ in scripts if '.nodes.' in module}
    assert nodes == started


def imported_keys(paths, beside=frozenset()):
    """Return the keys of all imports but the standard library's and modules beside the files."""
    modules = {name.split('.')[0] for path in paths for name in imports(path)}
    # _typeshed is in the type checker alone.
    modules -= {*sys.stdlib_module_names, '_typeshed', *beside}
    own = {module for module in modules if module in NAMES or ROS.match(module)}
    unknown = modules - own - ROSDEP.keys()
    assert not unknown, (
        'give it a key in ROSDEP, and a rule in tools/rosdep.yaml if rosdistro has none'
    )
    return own | {ROSDEP[module] for module in modules - own}


@each_package
def test_no_import_is_relative(folder):
    relative = {
        str(path)
        for path in sources(folder)
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8')))
        if isinstance(node, ast.ImportFrom) and node.level
    }
    assert not relative


@each_package
def test_package_xml_declares_exactly_what_is_imported(folder):
    manifest = parse_package(folder / 'package.xml')
    declared = {depend.name for depend in manifest.exec_depends}
    if manifest.name == 'lta_bringup':
        assert declared == STARTED
        return
    assert declared == imported_keys(sources(folder)) - {manifest.name}


@each_package
def test_package_xml_declares_exactly_what_the_build_imports(folder):
    manifest = parse_package(folder / 'package.xml')
    declared = {depend.name for depend in manifest.build_depends}
    assert declared == imported_keys([folder / 'setup.py'], {'setuptools'})


@each_package
def test_package_xml_declares_exactly_what_the_tests_import_besides(folder):
    """Other packages of LTA are not declared: some tests use those that depend on their own."""
    manifest = parse_package(folder / 'package.xml')
    declared = {depend.name for depend in manifest.test_depends}
    tests = [ROOT / 'test/conftest.py', *package_tests.list_files(manifest.name)]
    run = {depend.name for depend in manifest.exec_depends}
    assert declared == imported_keys(tests, HELPERS) - run - NAMES


def test_each_rule_of_rosdep_is_used_and_installs_what_the_requirements_name():
    rules = yaml.safe_load((ROOT / 'tools/rosdep.yaml').read_text())
    required = ''.join(path.read_text() for path in ROOT.glob('requirements*.txt')).split()
    declared = {
        depend.name
        for folder in FOLDERS
        for manifest in [parse_package(folder / 'package.xml')]
        for depend in manifest.exec_depends + manifest.test_depends
    }
    assert set(ROSDEP.values()) <= declared, 'a key that no package.xml uses'
    assert rules.keys() <= set(ROSDEP.values())
    for key, systems in rules.items():
        (name,) = systems['ubuntu']['pip']['packages']
        assert key == f'python3-{name}-pip'
        assert name in required


def test_imports_are_found_wherever_they_stand():
    tree = ast.parse("""
import numpy.linalg
def late():
    from scipy import stats
    return import_module('mcap.records'), importlib.import_module(name)
HEAD = 'from numba import njit\\n'
WORDS = 'import it from there'
""")
    assert imports_of(tree) == {'numpy.linalg', 'scipy.stats', 'mcap.records', 'numba.njit'}


def test_python_versions_are_the_same_everywhere():
    script = (ROOT / 'tools/environment.sh').read_text()
    lowest, end = re.search(r'\(3, (\d+)\) <= sys\.version_info < \(3, (\d+)\)', script).groups()
    words = f'3.{lowest} to 3.{int(end) - 1}'
    assert f'LTA needs Python {words}' in script
    for name in ('README.md', 'CONTRIBUTING.md', FIRST_FLIGHT, 'constraints.txt'):
        assert f'Python {words}' in (ROOT / name).read_text(), name
    wheel = (ROOT / 'tools/wheel/setup.py').read_text()
    assert f"python_requires='>=3.{lowest},<3.{end}'" in wheel
    lock = runpy.run_path(str(ROOT / 'tools/lock.py'))
    assert lock['PYTHONS'] == tuple(f'3.{minor}' for minor in range(int(lowest), int(end)))
    for outside in (int(lowest) - 1, int(end)):
        assert f'LTA needs Python {words};' in check_python_version((3, outside)).remedy
    for bound in (int(lowest), int(end) - 1):
        assert check_python_version((3, bound)).state == 'ok'


def test_packages_depend_to_the_left_only_as_the_architecture_says():
    page = (ROOT / 'docs/architecture.md').read_text()
    (line,) = re.findall(r'^Packages depend to the left only: (.*)\.$', page, re.MULTILINE)
    steps = [set(re.findall(r'`(\w+)`', step)) for step in line.split('<-')]
    assert set().union(*steps) == NAMES
    for step, left in zip(steps, accumulate(steps, set.union, initial=set()), strict=False):
        for folder in (folder for folder in FOLDERS if name_of(folder) in step):
            used = {name.split('.')[0] for path in sources(folder) for name in imports(path)}
            assert used & NAMES <= left | {name_of(folder)}, name_of(folder)


@pytest.mark.parametrize(
    'path',
    [path for folder in FOLDERS for path in sources(folder) if inside_the_fence(path)],
    ids=lambda path: str(path.relative_to(ROOT)),
)
def test_cores_know_no_ros(path):
    crossing = {name for name in imports(path) if FENCED.match(name) or BEYOND.match(name)}
    assert not crossing, 'ROS belongs in nodes/, messages.py and lta_graph/ros'


@each_package
def test_no_folder_has_so_many_modules_that_nobody_reads_their_names(folder):
    counts = Counter(path.parent for path in sources(folder) if path.name != '__init__.py')
    crowded = {str(path): count for path, count in counts.items() if count > MODULES}
    assert not crowded, 'give its modules groups'


def test_one_version_everywhere():
    said = {'CITATION.cff': yaml.safe_load((ROOT / 'CITATION.cff').read_text())['version']}
    for folder in FOLDERS:
        said[f'{folder}/setup.py'] = setup_of(folder)['version']
    for path in (ROOT / 'config/package.xml', *ROOT.glob('src/*/package.xml')):
        said[str(path)] = parse_package(path).version
    assert said == dict.fromkeys(said, VERSION)
    # What is said to be unreleased belongs to the next version, whichever that will be.
    parts = re.split(r'^## \[(.*)\].*$', (ROOT / 'CHANGELOG.md').read_text(), flags=re.MULTILINE)
    told = dict(zip(parts[1::2], parts[2::2], strict=True))
    assert told['Unreleased'].strip() or next(n for n in told if n != 'Unreleased') == VERSION
