"""`--help` of a node names all of its parameters and the topics of its role."""

from importlib import import_module

from lta_config.topics import load_topic_table
from lta_control.nodes.controller import Controller
from lta_graph.ros.node import GraphNode
from lta_graph.ros.node_help import asks_for_help, describe_node, find_topics, parse_module
from lta_graph.ros.parameters import iterate_fields
import pytest
from tools.reference.parameters import iterate_settings_models

NODES = {(package, name) for package, name, _ in iterate_settings_models()}
ROLES = ('controller', 'demodulator', 'energy_monitor', 'estimator', 'navigator')


def load(package, name):
    module = import_module(f'{package}.nodes.{name}')
    (found,) = [
        item
        for item in vars(module).values()
        if isinstance(item, type)
        and issubclass(item, GraphNode)
        and item.__module__ == module.__name__
    ]
    return found


@pytest.mark.parametrize(('package', 'name'), sorted(NODES))
def test_it_names_every_parameter(package, name):
    said = describe_node(load(package, name), f'install/{package}/lib/{package}/{name}')
    assert said.startswith(f'Usage: ros2 run {package} {name} ')
    models = [model for *whose, model in iterate_settings_models() if whose == [package, name]]
    for model in models:
        for parameter, *_ in iterate_fields(model()):
            assert f'\n  {parameter}' in said


@pytest.mark.parametrize(('package', 'name'), sorted(NODES))
def test_the_topics_of_a_role_are_those_of_the_table(package, name):
    table = load_topic_table()
    published, read, others = find_topics(parse_module(import_module(f'{package}.nodes.{name}')))
    assert set(table.published_by(name)) <= {*published} or others
    assert set(table.read_by(name)) <= {*read}
    if name in ROLES:
        assert set(published) == {*table.published_by(name), '/diagnostics'}


def test_units_bounds_and_defaults_are_told():
    said = describe_node(Controller, 'lib/lta_control/controller')
    assert '\n  tilt_limit (default 1.0, 0.1 to 3.2 rad): Tilt at which the motors stop.' in said
    assert '\n  vehicle (default gtmab, only at start): Vehicle name or file.\n' in said
    assert '\n  reads     odom (nav_msgs/msg/Odometry): Estimated pose' in said
    assert '\n  publishes motors (' in said


@pytest.mark.parametrize(
    ('words', 'wanted'),
    [
        (['node', '--help'], True),
        (['node', '--ros-args', '-r', '__ns:=/a', '-h'], True),
        (['--help'], False),
        (['node', '--ros-args', '-p', 'a:=--help'], False),
    ],
)
def test_help_may_be_asked_for_anywhere(words, wanted):
    assert asks_for_help(words) == wanted
