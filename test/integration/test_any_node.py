# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
What every node promises: it refuses a bad parameter in one sentence, with status 2, and no more.

That each starts alone, lives in silence and ends on Ctrl-C is in test_workspace.py; that it hears
what cannot be meant and goes on, in test_spoilt_inputs.py.
"""

from collections.abc import Sequence
import re

from lta_bridge.crazyflie.drone_lock import DroneLock
from ports import free_port, UDP
import pytest
from waiting import PATIENCE

from .peer import complaints, ROOT, start

Needs = dict[str, tuple[str, ...]]  # of a node, its words
MODULES = {
    path.stem: f'{path.parts[-3]}.nodes.{path.stem}'
    for path in sorted(ROOT.glob('src/*/*/nodes/*.py'))
    if path.stem != '__init__'
}
NEEDS: Needs = {  # without which it refuses, or meets others
    'live': ('-p', f'port:={free_port()}'),  # another graph of this machine may be looked at
    'player': ('-p', f'bag:={ROOT / "test/replay/lamp.mcap"}'),
    'teensy_bridge': ('-p', 'autostart:=false'),
}
TAKEN = f'udp://127.0.0.1:{free_port(UDP)}'
WRONG = [  # of a node, a value that it cannot have, and what it says
    ('crazyflie_bridge', 'uri:=udp://here', "'udp://here' is not a valid Crazyflie URI; give one"),
    ('crazyflie_bridge', f'uri:={TAKEN}', r'Another program \(process \d+\) already commands'),
    (
        'crazyflie_bridge',
        'crazyflie:=multirotor',
        "yaml' is for the vehicle multirotor, but gtmab",
    ),
    ('teensy_bridge', 'port:=/dev/ttyNOPE', 'There is no serial port /dev/ttyNOPE; plug'),
    (
        'teensy_bridge',
        'port:=udp://0.0.0.0:99999',
        'is not a UDP address to listen on; write udp:',
    ),
    ('energy_monitor', 'vehicle:=zeppelin', "Unknown vehicle 'zeppelin'; known: "),
    ('energy_monitor', 'reserve:=2.0', 'energy_monitor: parameter reserve'),
    ('demodulator', 'frequency:=6000.0', 'The beacon at 6000 Hz cannot be detected at 10000 sam'),
    ('recorder', 'topics:=odm', "Unknown topic 'odm'; known: /clock, "),
    ('simulator', 'wait_for:=estimater', "Unknown role in wait_for 'estimater'; known: contro"),
    ('player', 'bag:=""', 'has no bag'),
    (
        'estimator',
        'qos_overrides./lta1/odom.publisher.reliability:=good',
        'override for policy `reliability`: `good`',
    ),
]


def check_refused(cases: Sequence[tuple[str, str, str]], needs: Needs) -> None:
    """Start nodes side by side, each with a parameter, and check what they say and their end."""
    started = [start(MODULES[node], *needs.get(node, ()), '-p', word) for node, word, _ in cases]
    errors = [process.communicate(timeout=PATIENCE)[1] for process in started]
    for (node, word, sentence), process, text in zip(cases, started, errors, strict=True):
        assert process.returncode == 2, (node, word, text)
        assert re.search(sentence, text.strip().splitlines()[-1]), (node, word, text)
        assert len(complaints(text)) == 1, (node, word, text)


@pytest.mark.usefixtures('domain_id')
def test_a_parameter_that_it_does_not_have_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    check_refused([(node, 'nonsense:=1', 'nonsense') for node in MODULES], NEEDS)


@pytest.mark.usefixtures('domain_id')
def test_a_value_with_which_it_cannot_work_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    claim = DroneLock(TAKEN)
    check_refused(WRONG, {})
    claim.close()
    assert list(tmp_path.iterdir()) == []
