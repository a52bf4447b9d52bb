"""A parameter with which a node cannot work is refused with the sentence, and the node goes on."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

import pytest
from rcl_interfaces.srv import GetParameters, SetParameters
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 20.0  # s of wall time
CODE = 'from lta_vlc.nodes.demodulator import main; main()'
TOO_FAST = 'The beacon at 6000 Hz cannot be seen at 10000 samples/s; sample at more than twice'


def start(*arguments):
    paths = [str(path.parent) for path in ROOT.glob('src/*/package.xml')] + [str(ROOT / 'config')]
    return subprocess.Popen(
        [sys.executable, '-c', CODE, '--ros-args', '-r', '__ns:=/lta1', *arguments],
        env={**os.environ, 'PYTHONPATH': os.pathsep.join([*paths, *sys.path])},
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture
def ask(domain_id):
    """Return a function that calls one of the demodulator's services."""
    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain_id)
    node = rclpy.create_node('peer', namespace='/lta1', context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def call(kind, name, **fields):
        client = node.create_client(kind, f'demodulator/{name}')
        assert client.wait_for_service(PATIENCE)
        future = client.call_async(kind.Request(**fields))
        deadline = time.monotonic() + PATIENCE
        while not future.done():
            assert time.monotonic() < deadline, 'the node did not answer'
            executor.spin_once(timeout_sec=0.02)
        return future.result()

    yield call
    executor.shutdown()
    node.destroy_node()
    context.try_shutdown()


def frequency(ask, value):
    parameter = Parameter('frequency', value=value).to_parameter_msg()
    (result,) = ask(SetParameters, 'set_parameters', parameters=[parameter]).results
    (held,) = ask(GetParameters, 'get_parameters', names=['frequency']).values
    return result, held.double_value


def test_a_beacon_that_cannot_be_seen_is_refused_and_the_old_one_kept(ask):
    process = start()
    refused, held = frequency(ask, 6000.0)
    assert (refused.successful, held) == (False, 150.0)
    assert refused.reason.startswith(TOO_FAST)
    taken, held = frequency(ask, 175.0)
    assert (taken.successful, held) == (True, 175.0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, errors) == (0, '')


@pytest.mark.usefixtures('domain_id')
def test_at_the_start_it_is_one_sentence():
    process = start('-p', 'frequency:=6000.0')
    _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 2
    assert errors.startswith(f'demodulator: {TOO_FAST}')
    assert errors.count('\n') == 1
