"""A parameter with which a node cannot work is refused with the sentence, and the node goes on."""

import signal

import pytest
from rcl_interfaces.srv import GetParameters
from waiting import PATIENCE

from .peer import complaints, Peer, start

NODE = 'lta_vlc.nodes.demodulator'
TOO_FAST = 'The beacon at 6000 Hz cannot be detected at 10000 samples/s; sample at more than'


@pytest.fixture
def peer(domain_id):
    with Peer(domain_id) as made:
        yield made


def frequency(peer, value):
    result = peer.set('demodulator', 'frequency', value)
    (held,) = peer.ask(GetParameters, 'demodulator/get_parameters', names=['frequency']).values
    return result, held.double_value


def test_a_beacon_that_cannot_be_seen_is_refused_and_the_old_one_kept(peer):
    process = start(NODE)
    refused, held = frequency(peer, 6000.0)
    assert (refused.successful, held) == (False, 150.0)
    assert refused.reason.startswith(TOO_FAST)
    taken, held = frequency(peer, 170.0)
    assert (taken.successful, held) == (True, 170.0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, complaints(errors)) == (0, [])


@pytest.mark.usefixtures('domain_id')
def test_at_the_start_it_is_one_sentence():
    process = start(NODE, '-p', 'frequency:=6000.0')
    _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 2
    assert errors.startswith(f'demodulator: {TOO_FAST}')
    assert errors.count('\n') == 1
