"""The drawing of the wiring: pins of the firmware, motors of the Crazyflie file."""

from pathlib import Path
import re
from xml.etree import ElementTree

from lta_config.schema.crazyflie_file import load_crazyflie
from lta_model.vehicle import load_vehicle
from lta_vehicle.views.wiring import draw_wiring, PINS
import pytest

ROOT = Path(__file__).parents[3]
SVG = '{http://www.w3.org/2000/svg}'


def texts(name):
    drawing = draw_wiring(load_vehicle(name), load_crazyflie(name))
    return [
        (element.text or '', float(element.get('x')), float(element.get('y')))
        for element in ElementTree.fromstring(drawing).iter(f'{SVG}text')
    ]


def test_the_pins_are_those_of_the_firmware():
    sketch = (ROOT / 'firmware/light_board/teensy41/light_board.ino').read_text()
    pins = re.search(r'PINS\[DIODES\] = \{(.*)\}', sketch).group(1)
    assert tuple(pins.split(', ')) == PINS


def test_diodes_run_counter_clockwise_from_the_nose():
    places = {text: (x, y) for text, x, y in texts('gtmab')}
    nose, left, back, right = (places[pin] for pin in ('A0', 'A2', 'A4', 'A6'))
    assert nose[0] == back[0]
    assert left[1] == right[1]
    assert left[0] < nose[0] < right[0]
    assert nose[1] < left[1] < back[1]


@pytest.mark.parametrize('name', ['gtmab', 'multirotor'])
def test_each_rotor_stands_beside_its_motor(name):
    words = texts(name)
    places = {text: (x, y) for text, x, y in words}
    for motor, rotor in load_crazyflie(name).motors.items():
        x, y = places[motor.upper()]
        label = places[rotor.replace('_', ' ')]
        assert abs(label[0] - x) == pytest.approx(21.0)
        assert label[1] == pytest.approx(y - 5.0)


def test_a_rotor_on_the_left_is_drawn_on_the_left():
    places = {text: x for text, x, _ in texts('multirotor')}
    assert places['front left'] < places['front right']


def test_a_vehicle_without_panels_has_none():
    assert 'Solar panels' in dict.fromkeys(text for text, _, _ in texts('gtmab'))
    assert 'Solar panels' not in dict.fromkeys(text for text, _, _ in texts('multirotor'))


def test_the_picture_of_the_docs_is_this_drawing():
    drawing = draw_wiring(load_vehicle('gtmab'), load_crazyflie('gtmab'))
    assert (ROOT / 'docs/images/wiring.svg').read_text() == drawing
