"""What a bridge waits for is told, and nothing is armed meanwhile."""

from lta_emulation.crazyflie.commander import BenchBody
from lta_emulation.crazyflie.firmware import Firmware
from lta_emulation.crazyflie.server import CrazyflieServer
import pytest
from std_srvs.srv import SetBool
from waiting import PATIENCE

from .peer import Peer, start

CRAZYFLIE, TEENSY = 'crazyflie_bridge', 'teensy_bridge'


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
