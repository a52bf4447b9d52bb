"""Every line of bad input to the bridges, by the nodes themselves: one sentence, never armed."""

import re

from lta_bridge.crazyflie.drone_lock import DroneLock
from lta_emulation.crazyflie.body import BenchBody
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
from ports import free_port, UDP
import pytest
from std_srvs.srv import SetBool
from waiting import PATIENCE

from .peer import Peer, start

CRAZYFLIE, TEENSY = 'crazyflie_bridge', 'teensy_bridge'
TAKEN = f'udp://127.0.0.1:{free_port(UDP)}'
REFUSED = [
    (CRAZYFLIE, 'uri:=udp://here', r"'udp://here' is not a valid Crazyflie URI; give one such as"),
    (
        CRAZYFLIE,
        f'uri:={TAKEN}',
        r'Another program \(process \d+\) already commands the Crazyflie udp.*; stop it',
    ),
    (CRAZYFLIE, 'command:=override', r'tether the drone to a bench and add tethered:=true'),
    (
        CRAZYFLIE,
        'crazyflie:=multirotor',
        r"multirotor\.yaml' is for the vehicle multirotor, but gtmab is",
    ),
    (TEENSY, 'port:=/dev/ttyNOPE', r'There is no serial port /dev/ttyNOPE'),
    (
        TEENSY,
        'port:=udp://0.0.0.0:99999',
        r'is not a UDP address to listen on; write udp://0.0.0.0:14550',
    ),
]


def test_what_cannot_be_ends_the_node_with_one_sentence_and_status_2(domain_id):
    claim = DroneLock(TAKEN)
    started = [start(f'lta_bridge.nodes.{node}', '-p', word) for node, word, _ in REFUSED]
    told = [process.communicate(timeout=PATIENCE)[1] for process in started]
    claim.close()
    for (_, _, sentence), process, text in zip(REFUSED, started, told, strict=True):
        assert process.returncode == 2, text
        assert re.search(sentence, text.strip().splitlines()[-1]), text
        assert 'Traceback' not in text


DENIED = (  # as cflib passes on what libusb says
    'import cflib.crazyflie\n'
    'def refuse(drone, uri):\n'
    '    why = "USBError: [Errno 13] Access denied (insufficient permissions)"\n'
    '    drone.connection_failed.call(uri, why)\n'
    'cflib.crazyflie.Crazyflie.open_link = refuse\n'
)


@pytest.mark.parametrize(
    ('uri', 'before', 'sentence'),
    [
        pytest.param(
            'usb://7',
            '',
            'the Crazyflie of the URI is not connected by USB: plug it in and switch it on',
            marks=pytest.mark.long,
        ),
        pytest.param(
            'usb://0',
            DENIED,
            'no permission to open the USB device: add the udev rule of',
            marks=pytest.mark.long,
        ),
        ('old', '', 'the firmware has protocol version 7, but must have 9 or newer: update'),
    ],
)
def test_what_may_yet_come_is_told_and_waited_for_and_never_armed(
    domain_id, hear, uri, before, sentence
):
    with CrazyflieServer(Firmware(BenchBody(), protocol=7)) as server, Peer(domain_id) as peer:
        place = server.uri if uri == 'old' else uri
        node = start(f'lta_bridge.nodes.{CRAZYFLIE}', '-p', f'uri:={place}', before=before)
        name = f'{CRAZYFLIE}: link'
        hear(lambda facts: name in facts and sentence in facts[name].message)
        refused = peer.ask(SetBool, f'{CRAZYFLIE}/arm', data=True)
        assert not refused.success
        assert sentence in refused.message
        node.send_signal(2)
        _, text = node.communicate(timeout=PATIENCE)
        assert f'link: {sentence}' in text
        assert node.returncode == 0
        assert server.firmware.body.duties == (0.0,) * 4
