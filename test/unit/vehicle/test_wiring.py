# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The drawing of the wiring in docs/: pins of the firmware, motors of the Crazyflie file."""

from pathlib import Path
import re
from xml.etree import ElementTree

from lta_config.schema.crazyflie_file import load_crazyflie
import pytest

ROOT = Path(__file__).parents[3]
PLACES = {
    element.text or '': (float(element.get('x')), float(element.get('y')))
    for element in ElementTree.parse(ROOT / 'docs/images/wiring.svg').iter(
        '{http://www.w3.org/2000/svg}text'
    )
}


def test_the_pins_are_those_of_the_firmware_counter_clockwise_from_the_nose():
    sketch = (ROOT / 'firmware/light_board/teensy41/light_board.ino').read_text()
    pins = re.search(r'PINS\[DIODES\] = \{(.*)\}', sketch).group(1).split(', ')
    assert pins == sorted(text for text in PLACES if re.fullmatch(r'A\d', text))
    nose, left, back, right = (PLACES[pin] for pin in pins[::2])
    assert left[0] < nose[0] == back[0] < right[0]
    assert nose[1] < left[1] == right[1] < back[1]


def test_each_rotor_stands_beside_its_motor():
    for motor, rotor in load_crazyflie('gtmab').motors.items():
        x, y = PLACES[motor.upper()]
        label = PLACES[rotor.replace('_', ' ')]
        assert abs(label[0] - x) == pytest.approx(21.0)
        assert label[1] == pytest.approx(y - 5.0)
