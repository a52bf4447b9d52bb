# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The topic table, the nodes, the launch files and the parameters say one and the same."""

import ast
from pathlib import Path
from xml.etree import ElementTree

from lta_bridge.parameters import (
    CrazyflieBridgeSettings,
    DescriptionSettings,
    LiveSettings,
    PilotSettings,
    PlayerSettings,
    RecorderSettings,
    TeensyBridgeSettings,
    TeleopSettings,
    TrackerSettings,
)
from lta_bridge.playback.node_selection import list_replayable_roles, select_nodes
from lta_config.settings import Settings
from lta_config.topics import load_topic_table, Topic
from lta_control.parameters import ControllerSettings, EstimatorParameters, NavigatorParameters
from lta_energy.nodes.energy_monitor import EnergyMonitorParameters
from lta_graph.launch_arguments import FlyArguments
from lta_graph.launches import DRONE_NODES, FLY
from lta_graph.ros.message_validation import find_message_type
from lta_graph.ros.node import ACKNOWLEDGE_TIME, GraphSettings
from lta_graph.ros.parameters import build_descriptor, iterate_fields
from lta_graph.ros.qos import select_profile, select_reader_profile
from lta_model.scenario import load_scenario
from lta_model.vehicle import load_vehicle
from lta_sim.drone import SimulatorSettings
from lta_vlc.nodes.demodulator import DemodulatorParameters
import pytest
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
import yaml

ROOT = Path(__file__).resolve().parents[2]
TABLE = load_topic_table()
FAST_DDS = ROOT / 'config/fastdds'
ROLES = {
    'simulator': 'vehicle',
    'crazyflie_bridge': 'vehicle',
}  # nodes that play a role of another name
SOURCES = {
    'sim': 'simulator',
    'replay': 'player',
    'crazyflie': 'crazyflie_bridge',
}  # who plays the vehicle
NODES = {
    'crazyflie_bridge': CrazyflieBridgeSettings,
    'simulator': SimulatorSettings,
    'player': PlayerSettings,
    'estimator': EstimatorParameters,
    'controller': ControllerSettings,
    'demodulator': DemodulatorParameters,
    'navigator': NavigatorParameters,
    'energy_monitor': EnergyMonitorParameters,
    'recorder': RecorderSettings,
    'live': LiveSettings,
}
# Plays a part of the vehicle beside whoever plays the rest.
BRIDGES = {'teensy_bridge': TeensyBridgeSettings, 'tracker': TrackerSettings}
# Stand beside the graph: they serve people, and no row of the table waits for them.
BESIDE = {'description': DescriptionSettings, 'pilot': PilotSettings, 'teleop': TeleopSettings}
LISTENERS = {'live'}  # subscribes for itself: raw, to all that the table lists
PARTIAL = {'crazyflie_bridge'}  # a real drone says less than the simulator
# map -> odom, by who knows the place in the map; the row names who publishes the other frames
ADDED = {'simulator': {'/tf_static'}, 'tracker': {'/tf'}}
FILES = {path.stem: path for path in ROOT.glob('src/*/lta_*/nodes/[!_]*.py')}

each_node = pytest.mark.parametrize('name', NODES)
each_topic = pytest.mark.parametrize('name', TABLE.topics)


def calls(node, method):
    """Yield the first argument of each `self.method(...)` in a node's file, as an expression."""
    for item in ast.walk(ast.parse(FILES[node].read_text(encoding='utf-8'))):
        if (
            isinstance(item, ast.Call)
            and isinstance(item.func, ast.Attribute)
            and item.func.attr == method
            and isinstance(item.func.value, ast.Name)
            and item.func.value.id == 'self'
        ):
            yield item.args[0]


def triggers(node):
    """Return what a node gives `self.listen` as its trigger."""
    found = set()
    for item in ast.walk(ast.parse(FILES[node].read_text(encoding='utf-8'))):
        if isinstance(item, ast.Call) and getattr(item.func, 'attr', '') == 'subscribe_inputs':
            given = {word.arg: word.value for word in item.keywords}
            found.add((given.get('trigger') or item.args[1]).value)
    return found


def published(node):
    """Return the topics that a node makes publishers for."""
    found = {item.value for item in calls(node, 'create_output') if isinstance(item, ast.Constant)}
    role = ROLES.get(node, node)
    if f"self.table.published_by('{role}')" in FILES[node].read_text(encoding='utf-8'):
        found |= set(TABLE.published_by(role))
    return found


def read(node):
    """Return the topics that a node listens to."""
    lists = [item for item in calls(node, 'subscribe_inputs') if isinstance(item, ast.List)]
    return {item.value for each in lists for item in each.elts}


def test_every_node_is_known_here():
    assert set(FILES) == {*NODES, *BRIDGES, *BESIDE}


@pytest.mark.parametrize('name', BRIDGES)
def test_a_bridge_plays_a_part_of_the_vehicle(name):
    rows = {*TABLE.published_by('vehicle'), *TABLE.published_by(name)}
    assert published(name) - ADDED.get(name, set()) <= rows
    assert published(name)
    assert read(name) <= set(TABLE.read_by('vehicle'))


@pytest.mark.parametrize('name', BESIDE)
def test_who_stands_beside_publishes_what_the_table_gives_it(name):
    assert published(name) == set(TABLE.published_by(name))


@each_node
def test_a_node_publishes_what_the_table_gives_it(name):
    given = set(TABLE.published_by(ROLES.get(name, name))) | ADDED.get(name, set())
    assert published(name) <= given if name in PARTIAL else published(name) == given


@each_node
def test_a_node_reads_what_the_table_sends_it(name):
    assert read(name) == set(TABLE.read_by(ROLES.get(name, name)))


@each_node
def test_no_node_goes_around_the_table(name):
    """Only who shows everything subscribes for itself."""
    text = FILES[name].read_text(encoding='utf-8')
    assert 'create_publisher' not in text
    assert text.count('create_subscription') == (1 if name in LISTENERS else 0)


@each_topic
def test_a_topic_s_row_is_whole(name):
    topic = TABLE[name]
    fields = find_message_type(topic).get_fields_and_field_types()
    assert topic.stamped == ('header' in fields), 'stamped says whether there is a header'
    assert topic.about.endswith('.')
    roles = {ROLES.get(node, node) for node in NODES}
    assert topic.source in roles | set(BESIDE) | set(BRIDGES) | {'every node'}
    assert set(topic.subscribers) <= roles
    assert all(lag in (0, 1) for lag in topic.subscribers.values())
    assert topic.period_ns % 1_000_000 == 0
    # What somebody waits for must have a rhythm, or nobody could tell that it is missing.
    assert topic.period_ns > 0 or not topic.subscribers


@each_node
def test_a_node_answers_what_the_table_says(name):
    """The trigger that a node listens to is what all its topics answer."""
    answered = {TABLE[topic].answers for topic in TABLE.published_by(name)} - {''}
    if ROLES.get(name) != 'vehicle':  # who plays the vehicle answers nobody
        assert answered == triggers(name)
        assert answered == ({TABLE.trigger_topic(name)} - {''})
        assert all(name in TABLE[topic].subscribers for topic in answered)


def test_an_answer_has_the_rhythm_of_what_it_answers():
    found = [topic for topic in TABLE.topics.values() if topic.answers]
    assert found
    for topic in found:
        assert topic.period_ns == TABLE[topic.answers].period_ns
        assert topic.latency_ns >= TABLE[topic.answers].latency_ns
        assert topic.repeatable


def test_a_replay_runs_or_plays_every_node_of_the_graph():
    assert set(list_replayable_roles(TABLE)) == set(NODES) - {
        *SOURCES.values(),
        'recorder',
        'live',
    }
    whole = select_nodes(TABLE, [], [])
    sent = {*whole.played, *whole.answers}
    # What describes a drone is published anew by the graph of a replay
    described = {'/tf', *TABLE.published_by('description')}
    assert {name for name, row in TABLE.topics.items() if row.repeatable} - described == sent


@each_topic
def test_whoever_asks_for_reliable_messages_gets_them(name):
    topic: Topic = TABLE[name]
    real, step = select_profile(topic, lockstep=False), select_profile(topic, lockstep=True)
    assert real.reliability == ReliabilityPolicy.RELIABLE
    assert select_reader_profile(topic, lockstep=True) == step
    asked = select_reader_profile(topic, lockstep=False)
    best_effort = asked.reliability == ReliabilityPolicy.BEST_EFFORT
    assert best_effort == (topic.qos == 'sensor')
    latched = DurabilityPolicy.TRANSIENT_LOCAL
    assert (real.durability == latched) == (topic.qos == 'latched')
    if topic.repeatable:
        assert (step.reliability, step.durability) == (ReliabilityPolicy.RELIABLE, latched)
        assert step.depth * topic.period_ns >= 10 * 10**9 or not topic.period_ns


def test_five_sensors_are_read_best_effort_and_the_command_is_one_deep():
    assert {name for name, topic in TABLE.topics.items() if topic.qos == 'sensor'} == {
        'imu',
        'range',
        'pressure',
        'photodiodes',
        'illuminance',
    }
    assert select_profile(TABLE['motors'], lockstep=False).depth == 1


@pytest.mark.parametrize('name', [*NODES, *BRIDGES, *BESIDE])
def test_every_parameter_is_described(name):
    settings = {**NODES, **BRIDGES, **BESIDE}[name]()
    for key, info, value in [*iterate_fields(GraphSettings()), *iterate_fields(settings)]:
        descriptor = build_descriptor(info, value)
        assert descriptor.description.split('[')[0].strip(), key
        if isinstance(value, bool | str | tuple):
            continue  # ROS has ranges for numbers alone; the model holds the bounds of a list
        ranged = descriptor.integer_range or descriptor.floating_point_range
        assert ranged, f'{key} has no range'
        assert ranged[0].from_value <= value <= ranged[0].to_value, key


# Figures that hold from the start on: what a flight begins with, and what it is recorded with.
BEGUN_WITH = {
    'crazyflie_bridge': {
        'allow_other_commanders', 'blind', 'watchdog', 'patience', 'autostart',
    },
    'simulator': {'seed', 'offset_x', 'offset_y', 'record', 'commanded'},
    'player': {'rate', 'start', 'end', 'patience', 'record'},
    'estimator': {'rest_time'},
    'controller': {'armed'},
    'navigator': {'commanded'},
    'recorder': {
        'commanded', 'seed', 'offset_x', 'offset_y', 'queue_size',
    },
    'live': {'port'},
    'teensy_bridge': {'peaks', 'patience', 'autostart'},
    'tracker': {'origin', 'body', 'delay', 'truth'},
    'description': {'map'},
    'pilot': {'seconds', 'room', 'x', 'y', 'height', 'seed'},
    'teleop': {
        'layout.forward', 'layout.turn', 'layout.climb', 'layout.take', 'layout.give_back',
        'layout.stop', 'layout.rest',
    },
}  # fmt: skip


@pytest.mark.parametrize('name', [*NODES, *BRIDGES, *BESIDE])
def test_structure_is_fixed_and_figures_are_not(name):
    """A name or a path needs a restart; a number can be tried in flight, but for those above."""
    found = list(iterate_fields({**NODES, **BRIDGES, **BESIDE}[name]()))
    texts = {key for key, _, value in found if isinstance(value, str)}
    fixed = {key for key, info, value in found if build_descriptor(info, value).read_only}
    assert fixed == texts | BEGUN_WITH.get(name, set())


@pytest.mark.parametrize('source', SOURCES)
def test_the_launch_file_starts_every_node_under_its_name(source):
    plan = FLY.build_plan({'source': source, 'live': 'true', 'description': 'false'})
    others = {name for key, name in SOURCES.items() if key != source}
    assert [process.name for process in plan.processes] == [n for n in NODES if n not in others]
    for process in plan.processes:
        assert process.name == process.executable
        assert process.namespace == '/lta1'
        assert FILES[process.name].parts[-4] == process.package
    assert [p.name for p in plan.processes if not p.on_exit_shutdown] == ['live']
    assert [p.name for p in plan.processes if p.planned] == [SOURCES[source]]


def test_the_description_is_published_and_does_not_end_a_flight():
    def described(**given):
        plan = FLY.build_plan(given)
        found = [process for process in plan.processes if process.name == 'description']
        assert not any(process.on_exit_shutdown for process in found)
        return [process.parameters for process in found]

    (given,) = described(frame_prefix='lta1/')
    assert set(given) <= {
        key
        for settings in (DescriptionSettings(), GraphSettings())
        for key, _, _ in iterate_fields(settings)
    } | {'use_sim_time'}
    assert (given['scene'], given['frame_prefix']) == ('lamp_room', 'lta1/')
    # Where a real or a replayed drone starts is not known
    assert described(source='crazyflie')[0]['scene'] == ''
    # Only where nobody says where odom is in the map, it begins there
    assert described(source='crazyflie')[0]['map']
    assert not described(source='crazyflie', tracker='true')[0]['map']
    assert not given['map']
    assert described(source='replay', replay='x')[0]['scene'] == ''
    assert described(description='false') == []
    (stepped,) = described(time='lockstep')
    assert (stepped['scene'], stepped['pose']) == ('lamp_room', '')
    # Whoever replaces the estimator need not know of /tf
    assert described(estimator='false')[0]['pose'] == 'odom'


def test_the_light_board_is_started_where_there_is_one():
    assert 'teensy_bridge' not in [process.name for process in FLY.build_plan({}).processes]
    plan = FLY.build_plan({'light_board': 'true', 'light_port': 'udp://0.0.0.0:14550'})
    (bridge,) = [process for process in plan.processes if process.name == 'teensy_bridge']
    assert (bridge.executable, bridge.package) == ('teensy_bridge', 'lta_bridge')
    own = {
        key
        for key, _, _ in [
            *iterate_fields(GraphSettings()),
            *iterate_fields(TeensyBridgeSettings()),
        ]
    }
    assert bridge.parameters.keys() <= own
    assert bridge.parameters['port'] == 'udp://0.0.0.0:14550'
    given = {item.name: item.default for item in FLY.list_arguments()}
    assert given['light_port'] == TeensyBridgeSettings().port


def test_every_text_of_the_launch_file_stays_a_text():
    """Names may look like numbers, dates or truths; only what is meant as such becomes one."""
    texts = {'vehicle': '1', 'scenario': 'yes', 'bag': '2026-11-20'}
    found = set()
    for process in FLY.build_plan({**texts, 'seed': '7', 'live': 'true'}).processes:
        defaults = {
            key: value for key, _, value in iterate_fields({**NODES, **BESIDE}[process.name]())
        }
        for key, value in process.parameters.items():
            if key in defaults:
                assert type(value) is type(defaults[key]), (process.name, key, value)
            if key in texts:
                assert value == texts[key], (process.name, key)
                found.add((process.name, key))
    assert {('simulator', 'vehicle'), ('energy_monitor', 'vehicle'), ('recorder', 'bag')} <= found


@each_node
def test_the_launch_file_gives_only_parameters_that_are_declared(name):
    own = {key for key, _, _ in [*iterate_fields(GraphSettings()), *iterate_fields(NODES[name]())]}
    (entry,) = (each for each in DRONE_NODES if each.executable == name)
    given = set(entry.build_process(FlyArguments()).parameters)
    assert given - {'use_sim_time'} <= own
    # Who plays the vehicle makes the time that all others use.
    assert ('use_sim_time' in given) == (name not in SOURCES.values())
    assert ('source' in given) == (name != 'simulator')
    assert 'time' in given


def test_the_recorder_is_told_the_gains_that_the_controller_gets(tmp_path):
    gains = tmp_path / 'gains.yaml'
    gains.write_bytes((ROOT / 'config/control/gtmab.yaml').read_bytes())
    processes = {each.name: each for each in FLY.build_plan({'gains': str(gains)}).processes}
    assert processes['controller'].parameter_file == str(gains)
    assert processes['recorder'].parameters['gains'] == str(gains)


def test_launch_arguments_are_documented_and_default_to_what_is_shipped():
    given = {item.name: item for item in FLY.list_arguments()}
    assert all(item.description.endswith('.') for item in given.values())
    load_vehicle(given['vehicle'].default)
    load_scenario(given['scenario'].default)
    for name in ('vehicle', 'scenario', 'strategy', 'seed', 'bag'):
        assert str(getattr(RecorderSettings(), name)) == given[name].default
    for name in ('host', 'port'):
        assert str(getattr(LiveSettings(), name)) == given[f'live_{name}'].default
    assert 'live' not in [process.name for process in FLY.build_plan({}).processes]
    assert given['time'].choices == ('realtime', 'lockstep')
    assert given['time'].default == GraphSettings().time


def test_the_shipped_gains_are_parameters_and_all_of_them():
    content = yaml.safe_load((ROOT / 'config/control/gtmab.yaml').read_text())
    given = content['/**/controller']['ros__parameters']['gains']

    def flat(tree, prefix):
        for key, value in tree.items():
            if isinstance(value, dict):
                yield from flat(value, f'{prefix}{key}.')
            else:
                yield prefix + key

    known = {key for key, _, _ in iterate_fields(ControllerSettings()) if key.startswith('gains.')}
    assert set(flat(given, 'gains.')) == known


@pytest.mark.parametrize('model', NODES.values(), ids=list(NODES))
def test_a_setting_beyond_its_bounds_is_refused(model):
    for key, info, value in iterate_fields(model()):
        ranges = build_descriptor(info, value).floating_point_range
        if not ranges:
            continue
        *path, last = key.split('.')
        tree = {last: ranges[0].to_value * 2 + 1}
        for part in reversed(path):
            tree = {part: tree}
        with pytest.raises(ValueError, match=last):
            model.model_validate(tree)
    assert issubclass(model, Settings)


@pytest.mark.parametrize('name', ['this_machine.xml', 'network.xml'])
def test_a_node_that_ends_waits_for_a_heartbeat(name):
    """Acknowledgements come after one: without it, the last report would leave unconfirmed."""
    form = '{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}'
    (period,) = ElementTree.parse(FAST_DDS / name).iter(f'{form}heartbeatPeriod')
    parts = [int(period.find(f'{form}{part}').text) for part in ('sec', 'nanosec')]
    assert 0.0 < parts[0] + 1e-9 * parts[1] < ACKNOWLEDGE_TIME
