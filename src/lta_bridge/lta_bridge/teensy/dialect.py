"""
The messages of the light board's link.

Written by tools/dialect.py from firmware/light_board/mavlink/link.xml; do not edit.
"""

from typing import Final

from lta_bridge.teensy.message import MavlinkMessage
import numpy as np

HEARTBEAT: Final = MavlinkMessage(
    0,
    'HEARTBEAT',
    50,
    np.dtype(
        [
            ('custom_mode', '<u4'),
            ('type', '<u1'),
            ('autopilot', '<u1'),
            ('base_mode', '<u1'),
            ('system_status', '<u1'),
            ('mavlink_version', '<u1'),
        ]
    ),
)
TIMESYNC: Final = MavlinkMessage(
    111,
    'TIMESYNC',
    34,
    np.dtype(
        [
            ('tc1', '<i8'),
            ('ts1', '<i8'),
        ]
    ),
)
LTA_LIGHT_BLOCK: Final = MavlinkMessage(
    53400,
    'LTA_LIGHT_BLOCK',
    191,
    np.dtype(
        [
            ('time_usec', '<u8'),
            ('sequence', '<u4'),
            ('samples', '<u2', (120,)),
            ('diodes', '<u1'),
            ('rows', '<u1'),
        ]
    ),
)
LTA_LIGHT_PEAKS: Final = MavlinkMessage(
    53401,
    'LTA_LIGHT_PEAKS',
    103,
    np.dtype(
        [
            ('time_usec', '<u8'),
            ('sequence', '<u4'),
            ('window', '<u4'),
            ('frequency', '<f4'),
            ('amplitude', '<f4', (16,)),
            ('noise', '<f4', (16,)),
            ('diodes', '<u1'),
        ]
    ),
)
LTA_LIGHT_STATUS: Final = MavlinkMessage(
    53402,
    'LTA_LIGHT_STATUS',
    193,
    np.dtype(
        [
            ('time_usec', '<u8'),
            ('rows', '<u4'),
            ('overruns', '<u4'),
            ('sample_rate', '<f4'),
            ('diodes', '<u1'),
            ('adc_bits', '<u1'),
            ('dialect', '<u1'),
            ('commit', '<u4'),
            ('vehicle', '<u4'),
        ]
    ),
)
MESSAGES: Final = {
    one.number: one
    for one in (HEARTBEAT, TIMESYNC, LTA_LIGHT_BLOCK, LTA_LIGHT_PEAKS, LTA_LIGHT_STATUS)
}
