"""Draw how a vehicle's boards, motors, photodiodes and supply are wired."""

from collections.abc import Iterator, Mapping
from html import escape
import math
from typing import Final, final, NamedTuple

from lta_config.schema.crazyflie_file import CrazyflieFile
from lta_model.sensors.photodiode import spread_azimuths
from lta_model.vehicle import Vehicle
from lta_report.palette import DARK, ESTIMATE, GRID, INK, PAPER, SOFT, TRUTH
from lta_vehicle.views.projection import Two

# Inputs of the light board in the order of the diodes (firmware/light_board/teensy41)
PINS: Final = tuple(f'A{i}' for i in range(8))
WIRING_WIDTH, WIRING_HEIGHT = 940.0, 600.0  # px
RING: Final = (195.0, 186.0, 95.0)  # px: centre of the diode ring and its radius
MOTOR_CIRCLE: Final = (
    195.0,
    478.0,
    80.0,
)  # px: centre of the motors, and how far off they are drawn
PART_SIZE: Final = (134.0, 48.0)  # px: size of a part
PART_COLUMNS: Final = (470.0, 664.0, 858.0)  # px: centres of the parts
WIRING_STYLE: Final = (
    f'svg{{background:{PAPER}}}text{{font:12px system-ui,sans-serif;fill:{INK}}}'
    f'.head{{font-weight:600;font-size:14px}}.note{{fill:{SOFT};font-size:11px}}'
    f'.part{{fill:{GRID};stroke:{INK}}}path{{fill:none;stroke-width:2}}'
    f'.power{{stroke:{ESTIMATE}}}.signal{{stroke:{TRUTH}}}.ring{{stroke:{SOFT};fill:none}}'
)


@final
class WiringPart(NamedTuple):
    """A box of the drawing: two lines of text and its centre. [px]"""

    name: str
    note: str
    at: Two


@final
class Lead(NamedTuple):
    """A lead between two boxes: their names, its kind ('power' or 'signal') and its label."""

    start: str
    end: str
    kind: str
    label: str = ''


def draw_wiring(vehicle: Vehicle, crazyflie: CrazyflieFile) -> str:
    """
    Return a standalone SVG: photodiodes and motors from above, supply and signals.

    The light board is left out if the vehicle does not have eight diodes, which is what its
    firmware samples.
    """
    has_board = vehicle.file.sensors.diodes.count == len(PINS)
    parts, leads = _list_parts(vehicle, has_board), _list_leads(vehicle, has_board)
    motors = {rotor: motor for motor, rotor in crazyflie.motors.items()}
    body = [
        *(_draw_ring() if has_board else ()),
        *_draw_motors(vehicle, motors),
        _text((390.0, 26.0), 'Supply and signals', 'head'),
        *(line for lead in leads for line in _draw_lead(lead, parts)),
        *(line for part in parts.values() for line in _draw_part(part)),
        f'<path class="power" d="M407 {WIRING_HEIGHT - 24}h24"/>',
        _text((438.0, WIRING_HEIGHT - 20.0), 'supply, with its ground'),
        f'<path class="signal" d="M592 {WIRING_HEIGHT - 24}h24"/>',
        _text((623.0, WIRING_HEIGHT - 20.0), 'signal'),
    ]
    dark = WIRING_STYLE
    for light in (PAPER, INK, SOFT, GRID, ESTIMATE, TRUTH):
        dark = dark.replace(light, DARK[light])
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIRING_WIDTH:.0f} '
        f'{WIRING_HEIGHT:.0f}" '
        f'role="img" aria-label="{escape(f"Wiring of {vehicle.file.name}")}">'
        f'<style>{WIRING_STYLE}@media(prefers-color-scheme:dark){{{dark}}}</style>'
        + '\n'.join(body)
        + '</svg>\n'
    )


def _list_parts(vehicle: Vehicle, has_board: bool) -> dict[str, WiringPart]:
    """Return the boxes by name, in rows from the panels down to the lamp."""
    left, middle, right = PART_COLUMNS
    capacity = 1e3 * vehicle.file.energy.battery.capacity.si / 3600.0
    solar = {
        'panels': WiringPart('Solar panels', 'to the charger only', (left, 70.0)),
        'charger': WiringPart('Charger', 'maximum power point', (middle, 70.0)),
    }
    board = {
        'boost': WiringPart('Boost converter', 'to 5 V', (middle, 284.0)),
        'teensy': WiringPart('Teensy 4.1', 'supply at VIN', (middle, 392.0)),
        'diodes': WiringPart('8 OPT101', '100 nF at each', (right, 392.0)),
        'link': WiringPart('Link', 'USB or WiFi', (left, 392.0)),
        'board': WiringPart('Lamp board', 'lamp.ino', (left, 510.0)),
        'switch': WiringPart('MOSFET', '10 kohm at its gate', (middle, 510.0)),
        'lamp': WiringPart('LED lamp', 'constant current', (right, 510.0)),
    }
    return {
        **(solar if vehicle.file.energy.array else {}),
        'cell': WiringPart('Cell', f'1S, {capacity:.0f} mAh', (right, 70.0)),
        'range': WiringPart('VL53L1x deck', 'looking down', (left, 177.0)),
        'crazyflie': WiringPart('Crazyflie', 'battery connector', (middle, 177.0)),
        'motors': WiringPart('Motors', 'M1 to M4', (right, 177.0)),
        **(board if has_board else {}),
    }


def _list_leads(vehicle: Vehicle, has_board: bool) -> list[Lead]:
    """Return the leads between the boxes."""
    leads = [
        Lead('cell', 'crazyflie', 'power', 'fuse or plug'),
        Lead('crazyflie', 'motors', 'power'),
        Lead('range', 'crazyflie', 'signal'),
    ]
    if vehicle.file.energy.array:
        leads += [Lead('panels', 'charger', 'power'), Lead('charger', 'cell', 'power')]
    if has_board:
        leads += [
            Lead('crazyflie', 'boost', 'power'),
            Lead('boost', 'teensy', 'power'),
            Lead('teensy', 'diodes', 'power', '3.3 V'),
            Lead('diodes', 'teensy', 'signal', f'{PINS[0]} to {PINS[-1]}'),
            Lead('link', 'teensy', 'signal'),
            Lead('board', 'switch', 'signal', '100 ohm'),
            Lead('switch', 'lamp', 'power'),
        ]
    return leads


def _draw_ring() -> Iterator[str]:
    """Yield the diodes around the light board, seen from above with the nose up."""
    x, y, radius = RING
    yield _text((20.0, 26.0), 'Photodiodes from above', 'head')
    yield f'<circle class="ring" cx="{x}" cy="{y}" r="{radius}"/>'
    yield _text((x, y - radius - 48.0), 'nose', 'note', 'middle')
    yield f'<path class="signal" d="M{x} {y - radius - 42:.0f}v16m-4 -12l4 -5l4 5"/>'
    yield from _draw_part(WiringPart('Teensy 4.1', 'inputs A0 to A7', (x, y)))
    for number, (pin, azimuth) in enumerate(zip(PINS, spread_azimuths(len(PINS)), strict=True), 1):
        # Body axes: x to the nose, which is up here, y to the left
        towards = -math.sin(azimuth), -math.cos(azimuth)
        at = x + radius * towards[0], y + radius * towards[1]
        yield f'<circle class="part" cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="12"/>'
        yield _text((at[0], at[1] + 4.0), str(number), anchor='middle')
        out = x + (radius + 30.0) * towards[0], y + (radius + 22.0) * towards[1] + 4.0
        yield _text(out, pin, 'note', 'middle')


def _draw_motors(vehicle: Vehicle, motors: Mapping[str, str]) -> Iterator[str]:
    """Yield the motors seen from above: connector, rotor and direction of thrust."""
    x, y, reach = MOTOR_CIRCLE
    yield _text((20.0, y - reach - 50.0), 'Motors from above, nose up', 'head')
    farthest = max(math.hypot(*rotor.place[:2]) for rotor in vehicle.rotors) or 1.0
    taken: list[Two] = []
    for rotor in vehicle.rotors:
        ahead, left = rotor.place[0] / farthest, rotor.place[1] / farthest
        at = x - reach * left, y - reach * ahead
        # Rotors that sit side by side, as those of a gondola do, would hide each other
        while any(math.dist(at, other) < 44.0 for other in taken):
            at = at[0], at[1] + 44.0
        taken.append(at)
        yield f'<circle class="part" cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="15"/>'
        yield _text((at[0], at[1] + 4.0), motors.get(rotor.name, '-').upper(), anchor='middle')
        side = -1.0 if at[0] < x else 1.0
        anchor = 'end' if side < 0.0 else 'start'
        yield _text((at[0] + 21.0 * side, at[1] - 1.0), rotor.name.replace('_', ' '), '', anchor)
        yield _text((at[0] + 21.0 * side, at[1] + 13.0), _name_thrust(rotor.axis), 'note', anchor)


def _name_thrust(axis: tuple[float, float, float]) -> str:
    """Return the body direction in which a rotor mainly pushes."""
    index = max(range(3), key=lambda i: abs(axis[i]))
    words = (('forward', 'backward'), ('left', 'right'), ('up', 'down'))[index]
    return f'pushes {words[0] if axis[index] > 0.0 else words[1]}'


def _draw_lead(lead: Lead, parts: Mapping[str, WiringPart]) -> Iterator[str]:
    """Yield a lead as horizontal and vertical lines, and its label."""
    (x1, y1), (x2, y2) = parts[lead.start].at, parts[lead.end].at
    if y1 == y2:
        # Supply and signal between the same two parts run side by side
        y = y1 - 10.0 if lead.kind == 'power' else y1 + 10.0
        low, high = min(x1, x2) + 0.5 * PART_SIZE[0], max(x1, x2) - 0.5 * PART_SIZE[0]
        yield f'<path class="{lead.kind}" d="M{low} {y}H{high}"/>'
        above = y - 5.0 if lead.kind == 'power' else y + 14.0
        yield _text((0.5 * (low + high), above), lead.label, 'note', 'middle')
        return
    middle = 0.5 * (y1 + y2)
    yield (
        f'<path class="{lead.kind}" '
        f'd="M{x1} {y1 + 0.5 * PART_SIZE[1]}V{middle}H{x2}V{y2 - 0.5 * PART_SIZE[1]}"/>'
    )
    yield _text((0.5 * (x1 + x2), middle - 5.0), lead.label, 'note', 'middle')


def _draw_part(part: WiringPart) -> Iterator[str]:
    """Yield a box with its two lines of text."""
    x, y = part.at
    yield (
        f'<rect class="part" x="{x - 0.5 * PART_SIZE[0]}" y="{y - 0.5 * PART_SIZE[1]}" '
        f'width="{PART_SIZE[0]}" '
        f'height="{PART_SIZE[1]}" rx="6"/>'
    )
    yield _text((x, y - 3.0), part.name, anchor='middle')
    yield _text((x, y + 13.0), part.note, 'note', 'middle')


def _text(at: Two, words: str, kind: str = '', anchor: str = 'start') -> str:
    return (
        f'<text class="{kind}" x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}">'
        f'{escape(words)}</text>'
    )
