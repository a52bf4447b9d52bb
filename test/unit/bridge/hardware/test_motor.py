# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta hardware bench: one motor, only after its name was typed, and none on any way out."""

from contextlib import closing
import io
import json
import os
import signal
import time

from bench_body import BenchBody
from lta_bridge.crazyflie.cflib_link import CflibLink
from lta_bridge.crazyflie.drone_lock import DroneLock
from lta_bridge.crazyflie.link import LinkFailed
from lta_bridge.crazyflie.log_table import LOG_BLOCKS
from lta_bridge.hardware.motor import interrupt_on_signals, MotorBench
from lta_config.schema.crazyflie_file import load_crazyflie
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
from lta_model.vehicle import load_vehicle
import pytest
from waiting import PATIENCE, wait_until

# cflib logs to files and sockets that its daemon threads close when they please.
pytestmark = [
    pytest.mark.filterwarnings('ignore::pytest.PytestUnraisableExceptionWarning'),
    pytest.mark.usefixtures('prompt_cflib'),
]

FILE, VEHICLE = load_crazyflie('gtmab'), load_vehicle('gtmab')


def await_turning(server):
    body = server.firmware.body
    wait_until(lambda: body.duties[1] > 0.0, 'the motor to turn', lambda: body.duties)


@pytest.fixture
def typed(monkeypatch):
    def put(text):
        monkeypatch.setattr('sys.stdin', io.StringIO(text))

    return put


@pytest.fixture
def drone():
    with CrazyflieServer(Firmware(BenchBody())) as server:
        yield server


def bench_of(server, motor='m2'):
    link = CflibLink(server.uri, LOG_BLOCKS, time.time_ns)
    link.open(PATIENCE)
    return link, MotorBench(link, FILE, VEHICLE, motor)


def at_rest(server):
    firmware = server.firmware
    return firmware.body.duties == (0.0,) * 4 and not firmware.supervisor.armed


def test_one_motor_turns_alone_and_stands_afterwards(drone, call, typed):
    typed('spin m2\n')
    words = ('--uri', drone.uri, '--duty', '0.2', '--seconds', '0.6', '--json')
    status, said = call('hardware', 'bench', 'm2', *words)
    assert status == 0, said.err
    told = json.loads(said.out)
    assert told['duty'] == pytest.approx(0.2, abs=0.001)
    assert told['others'] == pytest.approx(1.0 / 65535)  # the app's least, of m1
    assert told['alone']
    assert at_rest(drone)
    assert not drone.firmware.supervisor.is_locked


@pytest.mark.parametrize('text', ['', 'spin m1\n', 'y\n', 'spin\n'])
def test_without_its_name_typed_nothing_is_even_connected(drone, call, typed, text):
    typed(text)
    status, said = call('hardware', 'bench', 'm2', '--uri', drone.uri)
    assert status == 2
    assert said.err == "Cancelled: 'spin m2' was not typed, so no motor turned.\n"
    assert at_rest(drone)
    assert drone.firmware.log.blocks == {}


def test_a_drone_that_a_bridge_flies_is_left_alone(drone, call, typed):
    typed('spin m2\n')
    with closing(DroneLock(drone.uri)):
        status, said = call('hardware', 'bench', 'm2', '--uri', drone.uri)
    assert status == 2
    assert 'already commands the Crazyflie' in said.err
    assert drone.firmware.log.blocks == {}


@pytest.mark.parametrize('error', [KeyboardInterrupt, ValueError])
def test_ctrl_c_and_errors_stop_it(drone, error):
    link, bench = bench_of(drone)

    def fail(_):
        await_turning(drone)
        raise error

    with pytest.raises(error):
        bench.turn_motor(0.2, PATIENCE, fail)
    assert at_rest(drone)
    link.close()


def test_sigterm_stops_it(drone):
    link, bench = bench_of(drone)

    def end(_):
        await_turning(drone)
        os.kill(os.getpid(), signal.SIGTERM)

    with pytest.raises(KeyboardInterrupt), interrupt_on_signals():
        bench.turn_motor(0.2, PATIENCE, end)
    assert at_rest(drone)
    link.close()


def test_a_second_ctrl_c_waits_until_it_stands(drone):
    """One that interrupts it while it disarms; cflib's threads take signals as well as ours."""
    link, bench = bench_of(drone)
    sent = link.request_arming

    def arm(wanted):
        sent(wanted)
        if not wanted:
            os.kill(os.getpid(), signal.SIGINT)

    def end(_):
        await_turning(drone)
        link.request_arming = arm
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bench.turn_motor(0.2, PATIENCE, end)
    assert at_rest(drone)
    link.close()


def test_a_drone_that_falls_silent_is_disarmed_although_nobody_hears_it_say_so(drone):
    link, bench = bench_of(drone)

    def silence(been):
        drone.down.silent = been > 0.2

    with pytest.raises(LinkFailed, match='sent nothing for'):
        bench.turn_motor(0.2, PATIENCE, silence)
    wait_until(lambda: at_rest(drone), 'the end of the motor')
    link.close()


def test_a_link_that_is_cut_both_ways_leaves_it_to_the_app_aboard(drone):
    link, bench = bench_of(drone)

    def cut(been):
        drone.down.silent = drone.up.silent = been > 0.2

    with pytest.raises(LinkFailed):
        bench.turn_motor(0.2, PATIENCE, cut)
    body = drone.firmware.body
    wait_until(lambda: body.duties == (0.0,) * 4, 'the end of the motor', lambda: body.duties)
    link.close()


def test_a_drone_that_may_not_arm_says_why(drone):
    drone.firmware.voltage = 3.0
    link, bench = bench_of(drone)
    with pytest.raises(LinkFailed, match='charge it'):
        bench.turn_motor(0.2, 1.0, lambda _: None)
    assert at_rest(drone)
    link.close()


def test_without_the_app_nothing_turns(drone, call, typed):
    drone.firmware.parameters.values['lta.app'] = 0
    typed('spin m1\n')
    status, said = call('hardware', 'bench', 'm1', '--uri', drone.uri, '--seconds', '0.5')
    assert status == 1
    assert 'lta.app is 0, but must be 3 (version of the app that flies duties; flash' in said.err
    assert at_rest(drone)
