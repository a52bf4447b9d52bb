# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Every series of both layouts is a field of a message that the topic table lists."""

import json
from pathlib import Path
import re
import xml.etree.ElementTree as ET

import foxglove.layouts as sdk
from lta_bag.schemas import load_jazzy_types
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.topics import load_topic_table, robot_topic
import pytest
from rosbags.typesys.store import Nodetype

ROOT = Path(__file__).resolve().parents[2]
TABLE = load_topic_table()
TYPES = {robot_topic('lta1', name): topic.type for name, topic in TABLE.topics.items()}
ROTORS = list(load_vehicle_file('gtmab').rotors)
LAYOUT = json.loads((ROOT / 'config/foxglove/lta.json').read_text(encoding='utf-8'))
PLOTS = ET.parse(ROOT / 'config/plotjuggler/lta.xml').getroot()
TABS = ['Overview', 'Control', 'Light', 'Energy', 'Model']
NODES = [path.stem for path in ROOT.glob('src/*/lta_*/nodes/[!_]*.py')]

STEP = re.compile(r'\.@?(\w+)|\[(\d+|:)\]|\{(\w+)==("[^"]*")\}')
PANELS = {  # by Foxglove's name of a panel: what its SDK says of the panel's settings
    'Plot': sdk.PlotConfig(),
    'StateTransitions': sdk.StateTransitionsConfig(),
    '3D': sdk.ThreeDeeConfig(),
    'DiagnosticSummary': sdk.DiagnosticsSummaryConfig(),
}


def told(sources, text):
    """Return whether some node reports a task and a figure: read from the sources, not run."""
    return any(text in path.read_text(encoding='utf-8') for path in sources)


def figure_exists(topic, status, key):
    """Return whether a status of a diagnostic array holds a figure."""
    assert topic == '/diagnostics'
    node, _, task = status.removeprefix('lta1/').partition(': ')
    assert node in NODES, status
    sources = list(ROOT.glob(f'src/*/lta_*/nodes/{node}.py'))
    sources += [*ROOT.glob('src/*/lta_*/*.py')]
    return told(sources, f"'{task}'") and told(sources, key)


def follow(type_name, steps):
    """Return the type that a message path ends at, by the definitions of ROS 2 Jazzy."""
    node, filters, name_before = (Nodetype.NAME, type_name), {}, ''
    steps = list(steps)
    while steps:
        name, index, key, value = steps.pop(0)
        kind, detail = node
        if name in ('rpy', 'degrees'):
            if name == 'rpy':
                assert detail == 'geometry_msgs/msg/Quaternion'
                angle, *_ = steps.pop(0)
                assert angle in ('roll', 'pitch', 'yaw')
                node = (Nodetype.BASE, ('float64', 0))
            assert node[0] == Nodetype.BASE
        elif name:
            fields = dict(load_jazzy_types().fielddefs[detail][1])
            assert name in fields, f'{detail} has no {name}'
            node, name_before = fields[name], name
        elif index:
            assert kind in (Nodetype.SEQUENCE, Nodetype.ARRAY)
            node = detail[0]
            if index != ':':
                assert int(index) < (8 if name_before == 'snr' else len(ROTORS))
        else:
            assert key in dict(load_jazzy_types().fielddefs[detail][1])
            filters[key] = value.strip('"')
    return node, filters


def parsed(path):
    """Return topic and steps of a Foxglove message path; every letter of it is understood."""
    topic = max((name for name in TYPES if re.match(rf'{re.escape(name)}[.\[{{]', path)), key=len)
    rest = path.removeprefix(topic)
    steps, end = [], 0
    for match in STEP.finditer(rest):
        assert match.start() == end, path
        steps.append(match.groups())
        end = match.end()
    assert end == len(rest), path
    return topic, steps


def every_path():
    return sorted(
        {
            item['value']
            for config in LAYOUT['configById'].values()
            for item in config.get('paths', [])
        }
    )


@pytest.mark.parametrize('path', every_path())
def test_a_message_path_ends_at_a_number(path):
    topic, steps = parsed(path)
    (kind, detail), filters = follow(TYPES[topic], steps)
    assert kind == Nodetype.BASE
    if topic == '/lta1/energy/status' and detail[0] == 'string':  # states are texts, too
        assert path.endswith('message')
    elif detail[0] == 'string':  # Foxglove plots a text that is a number
        assert filters.get('hardware_id', '') == ('lta1' if topic == '/diagnostics' else '')
        assert figure_exists(topic, filters['name'], filters['key'])
    else:
        assert detail[0] in ('float32', 'float64', 'bool', 'uint16')


@pytest.mark.parametrize('curve', sorted({item.get('name') for item in PLOTS.iter('curve')}))
def test_a_curve_is_one_that_plotjuggler_makes(curve):
    """By its ROS parsers: joints by name, figures by robot and status, angles in degrees."""
    topic = max((name for name in TYPES if curve.startswith(f'{name}/')), key=len)
    steps = curve.removeprefix(f'{topic}/').split('/')
    if TYPES[topic] == 'diagnostic_msgs/msg/DiagnosticArray':
        if topic == '/diagnostics':
            assert (steps.pop(0), steps.pop(0)) == ('lta1', 'lta1')
        assert figure_exists(topic, *steps)
        return
    if curve.endswith(']'):
        path = '.'.join([topic, *steps])
        (kind, _), _ = follow(TYPES[topic], parsed(path)[1])
        assert kind == Nodetype.BASE
        return
    if steps[-1].endswith('_deg'):
        assert steps.pop() in ('roll_deg', 'pitch_deg', 'yaw_deg')
        (_, detail), _ = follow(TYPES[topic], [(step, '', '', '') for step in steps])
        assert detail == 'geometry_msgs/msg/Quaternion'
        return
    (kind, _), _ = follow(TYPES[topic], [(step, '', '', '') for step in steps])
    assert kind == Nodetype.BASE


def test_both_layouts_have_the_five_tabs_and_the_same_plots():
    configs = LAYOUT['configById']
    tabs = configs[LAYOUT['layout']]['tabs']
    assert [tab['title'] for tab in tabs] == TABS
    assert [tab.get('tab_name') for tab in PLOTS.iter('Tab')] == TABS
    for tab, page in zip(tabs, PLOTS.iter('Tab'), strict=True):
        found = [name for name in leaves(tab['layout']) if name.startswith('Plot!')]
        # The newest block over its samples is a plot of Foxglove's alone
        found = [name for name in found if configs[name]['xAxisVal'] == 'timestamp']
        titles = [configs[name]['foxglovePanelTitle'] for name in found]
        assert titles == [area.get('name') for area in page.iter('DockArea')]
        counts = [len(configs[name]['paths']) for name in found]
        assert counts == [len(list(area.iter('curve'))) for area in page.iter('DockArea')]


def leaves(layout):
    """Yield the panels of a layout, in order; each split is whole."""
    if isinstance(layout, str):
        yield layout
        return
    assert layout['direction'] in ('row', 'column')
    assert 0.0 < layout['splitPercentage'] < 100.0
    yield from leaves(layout['first'])
    yield from leaves(layout['second'])


def test_every_panel_is_shown_once_and_has_settings_that_foxglove_knows():
    configs = LAYOUT['configById']
    shown = [name for tab in configs['Tab!lta']['tabs'] for name in leaves(tab['layout'])]
    assert sorted([*shown, 'Tab!lta']) == sorted(configs)
    for name in shown:
        known = PANELS[name.partition('!')[0]]._to_dict().keys()
        assert configs[name].keys() - {'foxglovePanelTitle'} <= known, name
        for series in configs[name].get('paths', []):
            assert series.keys() <= sdk.PlotSeries()._to_dict().keys()
    point = sdk.BaseRendererPointCloudTopicSettings()._to_dict().keys()
    for name, config in configs.items():
        for topic, settings in config.get('topics', {}).items():
            assert topic in TYPES, name
            assert settings.keys() <= point


def test_the_scene_of_a_bag_is_room_and_drone():
    (scene,) = [
        config for config in LAYOUT['configById'].values() if 'grid' in config.get('layers', {})
    ]
    (topic,) = scene['topics']
    assert TYPES[topic] == 'visualization_msgs/msg/MarkerArray'
    drone = scene['layers']['urdf']
    known = sdk.BaseRendererUrdfLayerSettings()._to_dict()
    assert drone.keys() <= known.keys()
    assert drone['layerId'] == known['layerId']
    assert (drone['sourceType'], TYPES[drone['topic']]) == ('topic', 'std_msgs/msg/String')
    # The frame that all others are drawn in has a row of its own
    assert scene['followTf'] == TABLE['scene'].frame == 'map'


def test_motors_are_shown_by_the_names_of_the_vehicle():
    plots = [each for each in LAYOUT['configById'].values() if 'paths' in each]
    (motors,) = [
        each['paths'] for each in plots if each['foxglovePanelTitle'].startswith('Motors')
    ]
    shown = {path['label'].replace(' ', '_'): path['value'] for path in motors}
    assert shown == {name: f'/lta1/motors.duty[{k}]' for k, name in enumerate(ROTORS)}
    curves = {item.get('name') for item in PLOTS.iter('curve')}
    assert {f'/lta1/motors/duty[{k}]' for k in range(len(ROTORS))} <= curves
