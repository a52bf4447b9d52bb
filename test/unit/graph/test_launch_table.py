# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Launches as people call them: names, arguments, files of their own, and the command lines."""

from pathlib import Path
import textwrap

from lta_config.errors import BadInput
from lta_config.settings import setting, Settings
from lta_graph.launch_plan import (
    format_ros_yaml,
    Launch,
    LaunchPlan,
    LaunchProcess,
    parse_arguments,
)
from lta_graph.launches import find_launch, FLEET, FLY
import pytest
import yaml

OWN = """
from lta_graph.launch_arguments import FlyArguments
from lta_graph.launch_plan import Launch, LaunchProcess
from lta_graph.launches import list_drone


def list_mine(arguments):
    return [*list_drone(arguments), LaunchProcess('mine', 'lidar', 'lidar', '/lta1')]


LAUNCH = Launch('mine', FlyArguments, list_mine)
"""


class TypedArguments(Settings):
    """An argument of each type."""

    text: str = setting('')
    """Any text."""
    count: int = setting(7)
    """A whole number."""
    size: float = setting(0.0)
    """A number."""
    on: bool = setting(True)
    """Yes or no."""


TYPED = Launch(
    'typed',
    TypedArguments,
    lambda a: [LaunchProcess('p', 'e', 'n', parameters=a.model_dump(), planned=a.on)],
)


@pytest.fixture
def write(tmp_path):
    def write(text: str, name: str = 'own.launch.py') -> Path:
        path = tmp_path / name
        path.write_text(textwrap.dedent(text), encoding='utf-8')
        return path

    return write


def test_a_node_becomes_a_command_line_in_which_parameters_win_over_their_file():
    process = LaunchProcess(
        'lta_sim',
        'simulator',
        'sim',
        '/lta1',
        parameters={'seed': 7, 'gains.yaw.ki': 2.0},
        parameter_file='own.yaml',
        words=('--verbose', 'a b'),
    )
    assert process.arguments == (
        *('--verbose', 'a b', '--ros-args', '-r', '__node:=sim', '-r', '__ns:=/lta1'),
        *('--params-file', 'own.yaml', '-p', 'seed:=7', '-p', 'gains.yaw.ki:=2.0'),
    )
    assert LaunchProcess('p', 'e', 'n').arguments == ('--ros-args', '-r', '__node:=n')


def test_a_file_of_the_user_s_parameters_comes_last_for_every_node(tmp_path):
    path = tmp_path / 'lab.yaml'
    with pytest.raises(BadInput, match=f'There is no parameter file {path}; check the path'):
        FLY.build_plan({'params_file': str(path)})
    path.touch()
    for process in FLY.build_plan({'params_file': str(path), 'tracker': 'true'}).processes:
        assert process.arguments[-2:] == ('--params-file', str(path))


@pytest.mark.parametrize(
    ('words', 'sentence'),
    [
        ({'name': 'a-b'}, "'a-b' is not a valid node name; use letters, digits and _."),
        (
            {'name': 'n', 'namespace': '/1a'},
            "'/1a' is not a valid namespace; use letters, digits, _ and /.",
        ),
    ],
)
def test_a_name_that_ros_would_refuse_is_refused(words, sentence):
    with pytest.raises(BadInput) as caught:
        LaunchProcess('p', 'e', **words)
    assert str(caught.value) == sentence


@pytest.mark.parametrize(
    'value',
    ['y', 'nan', 'a: b', '# no', '"q"', "it's", '\\', '{}', 'ä\n', ' ', '5', True, -3, 1e300, 0.1],
)
def test_yaml_for_ros_reads_back_as_it_was(value):
    read = yaml.safe_load(format_ros_yaml([value, value]))
    # PyYAML wants a dot in a float; ROS's parser and JSON do not.
    read = [float(item) if isinstance(value, float) else item for item in read]
    assert read == [value, value]
    assert type(read[0]) is type(value)


@pytest.mark.parametrize(
    ('value', 'expected'), [(1e-5, '1e-05'), (float('inf'), '.inf'), (-float('inf'), '-.inf')]
)
def test_yaml_for_ros_has_its_own_words_for_numbers(value, expected):
    assert format_ros_yaml(value) == expected


@pytest.mark.parametrize(
    ('word', 'expected'),
    [
        ('text:=7', '7'),  # a text stays a text, whatever it looks like
        ('text:=2026-11-20', '2026-11-20'),
        ('text:=a:=b', 'a:=b'),
        ('text:=', ''),
        ('count:=-3', -3),
        ('size:=3', 3.0),
        ('on:=False', False),
        ('on:=1', True),
    ],
)
def test_an_argument_has_the_type_that_is_declared(word, expected):
    (process,) = TYPED.build_plan(parse_arguments([word])).processes
    value = process.parameters[word.partition(':=')[0]]
    assert value == expected
    assert type(value) is type(expected)


@pytest.mark.parametrize(
    ('launch', 'word', 'sentence'),
    [
        (
            TYPED,
            'num:=1',
            "Unknown launch argument 'num'; known: count, on, size, text.",
        ),
        (TYPED, 'count:=x', "The launch argument count is 'x', but must be a whole number."),
        (TYPED, 'size:=fast', "The launch argument size is 'fast', but must be a number."),
        (TYPED, 'on:=maybe', "The launch argument on is 'maybe', but must be true or false."),
        (FLY, 'robot:=1a', "'/1a' is not a valid namespace; use letters, digits, _ and /."),
        (FLY, 'gains:=/no/x.yaml', 'There is no gains file /no/x.yaml; check the path.'),
        (
            FLY,
            'time:=slow',
            "The launch argument time is 'slow', but must be 'realtime' or 'lockstep'.",
        ),
    ],
)
def test_a_wrong_argument_is_one_sentence(launch, word, sentence):
    with pytest.raises(BadInput) as caught:
        launch.build_plan(parse_arguments([word]))
    assert str(caught.value) == sentence


@pytest.mark.parametrize('word', ['seed', ':=3', ''])
def test_what_is_no_argument_is_refused(word):
    with pytest.raises(BadInput, match='is not a launch argument; write NAME:=VALUE'):
        parse_arguments(['seed:=1', word])
    assert parse_arguments(['seed:=1', 'seed:=2']) == {'seed': '2'}


def test_arguments_have_defaults_choices_and_meanings_as_text():
    listed = {each.name: each for each in TYPED.list_arguments()}
    assert [each.default for each in listed.values()] == ['', '7', '0.0', 'true']
    assert listed['size'].description == 'A number.'
    assert listed['size'].choices == ()
    by_name = {each.name: each for each in FLY.list_arguments()}
    assert by_name['time'].choices == ('realtime', 'lockstep')


def test_of_several_namespaces_a_process_is_called_by_its_own():
    first, second = LaunchProcess('p', 'x', 'e'), LaunchProcess('p', 'x', 'f', '/r1/sub')
    both = LaunchPlan((first, second))
    assert both.namespaces == ['', 'r1/sub']
    assert [both.label(process) for process in both.processes] == ['e', 'r1/sub/f']
    assert LaunchPlan((second,)).label(second) == 'f'


def test_one_process_runs_all_nodes_but_those_apart_and_gets_the_arguments():
    many, one = (FLY.build_plan({'live': 'true', 'processes': word}) for word in ('many', 'one'))
    assert [many.list_nodes(each) for each in many.started] == [
        [each.name] for each in many.processes
    ]
    common, live = one.started
    assert one.list_nodes(live) == ['live']
    assert one.list_nodes(common) == [each.name for each in one.processes if each.name != 'live']
    assert (common.package, common.executable) == ('lta_graph', 'one_process')
    assert common.arguments == ('fly', 'live:=true', 'processes:=one')
    # Its recorder gets the longest time to end
    assert (common.on_exit_shutdown, common.sigterm_timeout) == (True, 23.0)


def test_a_launch_is_called_by_its_name_or_by_the_path_of_a_file(write):
    assert find_launch('fly').arguments is FLY.arguments
    path = write(OWN)
    launch = find_launch(str(path))
    plan = launch.build_plan({'seed': '9'})
    assert plan.words == (str(path), 'seed:=9')  # for the process that runs several nodes
    *drone, own = plan.processes
    assert drone == list(FLY.build_plan({'seed': '9'}).processes)
    assert plan.label(own) == 'lidar'


@pytest.mark.parametrize(
    ('text', 'sentence'),
    [
        ('LAUNCH = 5', r"'.*own\.launch\.py' defines no LAUNCH; start it with ros2 launch, or"),
        ('x = 1 / 0', r'cannot be run as a launch file: ZeroDivisionError in line 1 \(division'),
        ('launch: [', r'cannot be run as a launch file: SyntaxError in line 1'),
    ],
)
def test_a_file_without_a_launch_is_one_sentence(write, text, sentence):
    with pytest.raises(BadInput, match=sentence):
        find_launch(str(write(text)))


def test_a_fleet_of_one_is_a_flight_with_simulator_and_recorder_in_common():
    *own, simulator, recorder = FLEET.build_plan({'n': '1'}).processes
    assert own == list(FLY.build_plan({'frame_prefix': 'lta1/', 'fleet': 'true'}).processes)
    assert (simulator.name, simulator.namespace) == ('simulator', '/')
    assert (recorder.name, recorder.namespace) == ('recorder', '/')
