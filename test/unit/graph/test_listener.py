# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Whose voice is whose on /diagnostics, and when silence means something."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lta_graph.ros import listener
from lta_graph.ros.listener import (
    ALL_NODES_TIME,
    DiagnosticsListener,
    LOADING_TIME,
    NODE_SILENCE_TIME,
)
import pytest


@pytest.fixture
def clock(monkeypatch):
    """Return a list whose only item is the time [s]."""
    now = [100.0]
    monkeypatch.setattr(listener.time, 'monotonic', lambda: now[0])
    return now


def said(*names):
    """Return what nodes say, written as 'ROBOT/NODE'."""
    return DiagnosticArray(
        status=[
            DiagnosticStatus(name=f'{name}: state', hardware_id=name.rpartition('/')[0])
            for name in names
        ]
    )


@pytest.mark.usefixtures('clock')
def test_of_several_robots_each_fact_has_its_robot_s_name():
    both, one = DiagnosticsListener('lta1', 'lta2', ''), DiagnosticsListener('lta2')
    for ears in (both, one):
        ears._on_diagnostics(
            said('lta1/estimator', 'lta2/estimator', 'recorder', 'lta3/estimator')
        )
    assert set(both.facts) == {
        'lta1/estimator: state',
        'lta2/estimator: state',
        'recorder: state',
    }
    assert both.find_pending_nodes(['lta1/estimator', 'lta2/estimator', 'recorder', 'other']) == [
        'other'
    ]
    assert set(one.facts) == {'estimator: state'}


def test_silence_means_nothing_before_all_have_spoken_and_could_speak_again(clock):
    ears = DiagnosticsListener('lta1', 'lta2')
    nodes = ['lta1/estimator', 'lta2/estimator']
    assert ears.find_silent_nodes(nodes) == []
    ears._on_diagnostics(said('lta1/estimator'))
    clock[0] += 3.0
    assert ears.find_silent_nodes(nodes) == []
    ears._on_diagnostics(said('lta2/estimator'))
    assert ears.find_silent_nodes(nodes) == []
    clock[0] += NODE_SILENCE_TIME + 0.01
    assert ears.find_silent_nodes(nodes) == nodes


def test_one_that_never_speaks_does_not_keep_silence_meaningless_for_ever(clock):
    ears = DiagnosticsListener('lta1')
    ears._on_diagnostics(said('lta1/estimator'))
    clock[0] += ALL_NODES_TIME + 0.01
    assert ears.find_silent_nodes(['estimator', 'theirs']) == []
    clock[0] += NODE_SILENCE_TIME + 0.01
    assert ears.find_silent_nodes(['estimator', 'theirs']) == ['estimator']
    ears._on_diagnostics(said('lta1/estimator'))
    assert ears.find_silent_nodes(['estimator', 'theirs']) == []
    clock[0] += LOADING_TIME
    assert ears.find_silent_nodes(['estimator', 'theirs'], required=False) == ['estimator']
    assert ears.find_silent_nodes(['theirs']) == ['theirs']
