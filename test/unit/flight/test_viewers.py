# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Who only looks at a graph, where people can look on, and `lta fly --live`."""

from dataclasses import replace

from lta_analysis.flights import FlyRequest
from lta_config.errors import BadInput
from lta_flight.viewers import find_viewers, report_live_views, require_free_live_ports
from lta_graph.launch_plan import LaunchPlan, LaunchProcess
import pytest
from rich.console import Console


def plan(port=8765, namespaces=('/lta1',)):
    """Return a plan with a recorder and a live view in each namespace."""
    parameters = {'host': '127.0.0.1', 'port': port}
    return LaunchPlan(
        tuple(
            LaunchProcess('lta_bridge', name, name, namespace, parameters=parameters)
            for namespace in namespaces
            for name in ('recorder', 'live')
        )
    )


def test_the_live_view_and_the_description_serve_viewers_only():
    assert find_viewers(plan()) == {'live'}
    assert find_viewers(plan(namespaces=('/a', '/b'))) == {'a/live', 'b/live'}
    assert find_viewers(LaunchPlan(plan().processes[:1])) == frozenset()
    describing = LaunchProcess('lta_bridge', 'description', 'description', '/lta1')
    assert find_viewers(LaunchPlan((describing,))) == {'description'}


def test_people_are_told_where_to_look():
    said = []
    report_live_views(plan(9000), said.append)
    live, layout = said
    assert 'https://app.foxglove.dev/?ds=foxglove-websocket&ds.url=ws://localhost:9000 ' in live
    assert 'foxglove/lta.json ' in layout
    report_live_views(LaunchPlan(plan().processes[:1]), said.append)
    assert len(said) == 2


def test_a_view_of_another_s_launch_file_may_keep_its_defaults_or_have_them_in_a_file():
    alone = LaunchProcess('lta_bridge', 'live', 'live', '/a')
    filed = LaunchProcess('lta_bridge', 'live', 'live', '/b', parameter_file='live.yaml')
    said = []
    report_live_views(LaunchPlan((alone, filed)), said.append)
    assert 'ws://localhost:8765 ' in said[0]
    assert len(said) == 2
    require_free_live_ports(LaunchPlan((filed, filed)))
    told = replace(filed, parameters={'port': 9000})
    with pytest.raises(BadInput, match='Two live views were given port 9000'):
        require_free_live_ports(LaunchPlan((told, told)))


@pytest.mark.parametrize('port', [0, 65536, '8765', 80.5, True])
def test_what_is_no_port_is_refused(port):
    with pytest.raises(BadInput, match='whole number from 1 to 65535'):
        require_free_live_ports(plan(port))


@pytest.mark.parametrize(
    ('given', 'expected'),
    [
        ({}, ('lockstep', None)),
        ({'live': True}, ('realtime', 8765)),
        ({'live': True, 'live_port': 9000}, ('realtime', 9000)),
        ({'live': True, 'time': 'lockstep'}, ('lockstep', 8765)),
        ({'time': 'realtime', 'live_port': 9000}, ('realtime', None)),
    ],
)
def test_a_live_flight_is_one_at_the_pace_of_those_who_look(monkeypatch, given, expected):
    orders = []

    def refuse(*_, time, live_port, **__):
        orders.append((time, live_port))
        raise BadInput('Enough.')

    monkeypatch.setattr('lta_flight.flight.fly_once', refuse)
    with pytest.raises(BadInput, match='Enough'):
        FlyRequest(**given).run(Console(quiet=True))
    assert orders == [expected]


def test_of_several_views_each_has_its_own_port_and_says_whose_it_is():
    def on(port, namespace):
        return plan(port, (namespace,)).processes

    with pytest.raises(BadInput, match='Two live views were given port 8765; give each a port'):
        require_free_live_ports(plan(namespaces=('/a', '/b')))
    said = []
    report_live_views(LaunchPlan(on(9000, '/a') + on(9001, '/b')), said.append)
    first, second, layout = said
    assert ':9000  (a; open it in a browser, or' in first
    assert ':9001  (b; open it in a browser, or' in second
    assert layout.startswith('Layout')
