"""
Write the light board's messages as Python: fields, their order on the wire and their checks.

Run as `.venv/bin/python tools/dialect.py` after a change of firmware/light_board/mavlink/*.xml.
pymavlink's own reader works out order and checks; it is needed here and by the tests alone.
"""

from pathlib import Path
import re

from pymavlink.generator import mavparse

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / 'firmware/light_board/mavlink'
TARGET = ROOT / 'src/lta_bridge/lta_bridge/teensy/dialect.py'
HEAD = '''"""
The messages of the light board's link.

Written by tools/dialect.py from firmware/light_board/mavlink/link.xml; do not edit.
"""

from typing import Final

from lta_bridge.teensy.message import MavlinkMessage
import numpy as np
'''
KINDS = {'int': 'i', 'uint': 'u', 'float': 'f'}


def layout(field: mavparse.MAVField) -> str:
    """Return a field as an entry of a numpy dtype."""
    kind = KINDS[re.sub(r'\d*_t.*|$', '', field.type, count=1)]
    length = f', ({field.array_length},)' if field.array_length else ''
    return f"('{field.name}', '<{kind}{field.type_length}'{length})"


def text() -> str:
    """Return the Python file."""
    parsed = [
        mavparse.MAVXML(str(SOURCE / name), wire_protocol_version='2.0')
        for name in ('link.xml', 'lta.xml')
    ]
    messages = sorted((m for xml in parsed for m in xml.message), key=lambda m: m.id)
    lines = [HEAD]
    for message in messages:
        lines += [
            f'{message.name}: Final = MavlinkMessage(',
            f'    {message.id},',
            f"    '{message.name}',",
            f'    {message.crc_extra},',
            '    np.dtype(',
            '        [',
            *(f'            {layout(field)},' for field in message.ordered_fields),
            '        ]',
            '    ),',
            ')',
        ]
    names = ', '.join(message.name for message in messages)
    lines += [f'MESSAGES: Final = {{\n    one.number: one\n    for one in ({names})\n}}', '']
    return '\n'.join(lines)


if __name__ == '__main__':
    TARGET.write_text(text(), encoding='utf-8')
