# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What people can say of a recording: settings, launch arguments and the page about them agree."""

from pathlib import Path
import re

from lta_bag.background_writer import FLUSH_PERIOD, REFRESH_PERIOD
from lta_bridge.nodes.recorder import LOOK_PERIOD
from lta_bridge.parameters import RecorderSettings, RobotOrigin
from lta_graph.launches import FLEET, FLY
from lta_graph.ros.parameters import iterate_fields
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / 'docs/recording.md'
SETTINGS = {
    name: default
    for name, _, default in iterate_fields(RecorderSettings())
    if name not in {*RobotOrigin.model_fields, 'robots', 'replay'}
}


@pytest.mark.parametrize('launch', [FLY, FLEET], ids=['fly', 'fleet'])
def test_every_setting_is_a_launch_argument_that_reaches_the_recorder(launch):
    declared = {item.name: item for item in launch.list_arguments()}
    given = {
        key: {'bag': 'b', 'topics': 'imu /rosout'}.get(key, str(3.5 + number))
        for number, key in enumerate(SETTINGS)
    }
    plan = launch.build_plan(given)
    told = {plan.label(item): item.parameters for item in plan.processes}
    for key, default in SETTINGS.items():
        assert declared[key].default == str(default), key
        assert declared[key].description.endswith('.'), key
        expected = given[key] if key in ('bag', 'topics') else float(given[key])
        assert told['recorder'][key] == expected, key
    simulators = [value for label, value in told.items() if label.endswith('simulator')]
    assert [each['topics'] for each in simulators] == ['imu /rosout'] * len(simulators)


def test_the_page_has_every_setting_with_its_default():
    rows = re.findall(r'^\| `(\w+)` \| (?:`?([\w./]+)`? )?\|', PAGE.read_text(), re.MULTILINE)
    assert dict(rows) == {key: str(default) for key, default in SETTINGS.items()}


def test_the_page_has_the_times_of_the_code():
    text = ' '.join(PAGE.read_text().split())
    for sentence in (
        f'within {LOOK_PERIOD} s of its appearance',
        f'to the operating system every {FLUSH_PERIOD} s',
        f'every {REFRESH_PERIOD:.0f} s and at the end',
    ):
        assert sentence in text, sentence
