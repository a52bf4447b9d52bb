# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Reconnection to a Crazyflie and the writes at connect, without a thread or a drone."""

from types import SimpleNamespace

from bench_body import BenchBody
from lta_bridge.crazyflie import connection_manager
from lta_bridge.crazyflie.connection_manager import ConnectionManager, enforce_parameters
from lta_bridge.crazyflie.drone_lock import is_port_closed
from lta_bridge.crazyflie.link import LinkFailed
from lta_config.schema.crazyflie_file import ExpectedParameter
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
import pytest


class Drone:
    """A link that records its calls and fails to open on request."""

    def __init__(self, parameters=None, fails=()):
        self.parameters, self.fails = parameters or {}, iter(fails)
        self.opened, self.written, self.closed = [], [], 0

    def open(self, deadline):
        self.opened.append(deadline)
        if next(self.fails):
            raise LinkFailed(f'try {len(self.opened)}')

    def read_parameter(self, name):
        return self.parameters.get(name)

    def write_parameter(self, name, value, deadline):
        self.written.append((name, value, deadline))

    def close(self):
        self.closed += 1


@pytest.fixture
def keep(monkeypatch, event_after):
    """Return a function that runs a keeper for some pauses and returns it with those pauses."""

    def keep(drone, waits, given_back=lambda: None, **more):
        leave = event_after(waits)
        again = SimpleNamespace(clear=lambda: None, is_set=lambda: False, wait=lambda: None)
        events = iter((leave, again))
        monkeypatch.setattr(connection_manager, 'threading', SimpleNamespace(
            Event=lambda: next(events),
            Thread=lambda target, **_: SimpleNamespace(start=target),
        ))  # fmt: skip
        return ConnectionManager(drone, {}, given_back, **more), leave.waited

    return keep


def test_each_failure_doubles_the_pause_from_half_a_second_to_eight(keep):
    drone, done = Drone(fails=[True] * 7), []
    kept, pauses = keep(drone, 7, lambda: done.append(True))
    assert pauses == [0.5, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0]
    assert drone.opened == [8.0] * 7  # the deadline of one try
    assert (kept.up, kept.why, kept.attempts) == (False, 'try 7', 7)
    assert (drone.closed, done) == (7, [True])


@pytest.mark.parametrize(
    ('patience', 'pauses'), [(0.0, [0.5]), (60.0, [connection_manager.LISTEN_PERIOD] * 2 + [0.5])]
)
def test_the_first_attempt_waits_until_somebody_listens(keep, patience, pauses):
    closed, drone = iter([True, True, False]), Drone(fails=[True])
    more = {'is_closed': lambda: next(closed), 'patience': patience}
    _, waited = keep(drone, len(pauses), **more)
    assert waited == pauses
    assert len(drone.opened) == 1


def test_a_port_is_closed_until_a_program_listens():
    with CrazyflieServer(Firmware(BenchBody(), drift=0.0)) as drone:
        assert not is_port_closed(drone.uri)
    assert is_port_closed(drone.uri)
    assert not is_port_closed('radio://0/80/2M/E7E7E7E7E7')


def test_a_link_that_was_up_is_tried_again_at_once_and_then_with_the_shortest_pause(keep):
    drone = Drone(fails=[True, True, False, True, True])
    kept, pauses = keep(drone, 4)
    assert pauses == [0.5, 1.0, 0.5, 1.0]
    assert (kept.attempts, drone.closed) == (5, 5)


def test_before_its_thread_has_begun_it_is_down_and_leaving_it_takes_five_seconds(monkeypatch):
    waited, alive = [], [True, False]
    thread = SimpleNamespace(start=lambda: None, join=waited.append, is_alive=lambda: alive.pop(0))
    flags = []
    event = SimpleNamespace(set=lambda: flags.append('set'))
    monkeypatch.setattr(
        connection_manager,
        'threading',
        SimpleNamespace(Event=lambda: event, Thread=lambda **_: thread),
    )
    kept = ConnectionManager(Drone(), {})
    assert (kept.up, kept.why, kept.attempts) == (False, 'connecting', 0)
    kept.up = True
    kept.reconnect('no packet')
    assert (kept.up, kept.why, flags) == (False, 'no packet', ['set'])
    kept.up = True
    assert [kept.close(), kept.close(1.5)] == [False, True]
    assert (kept.up, waited) == (False, [5.0, 1.5])


def want(value, write=True):
    return ExpectedParameter(value=value, write=write, why='why')


def test_what_turns_motors_is_switched_off_first_and_what_is_right_is_left():
    drone = Drone({'motorPowerSet.enable': 1.0, 'powerDist.idleThrust': 0.0, 'a': 1.0, 'b': 2.0})
    enforce_parameters(drone, {'a': want(1.0, write=False), 'b': want(3.0)})
    assert drone.written == [('motorPowerSet.enable', 0.0, 2.0), ('b', 3.0, 2.0)]
