"""
Create a vehicle file and its gains from what a pilot can weigh and measure.

Given are the size of the envelope, the mass without gas, and number, thrust and place of the
motors. Volume, lift, ballast, inertia and added mass follow from the file; the drag is estimated
by hand (`lta_sim.cfd.analytic`). Everything else is assumed, and marked so, with its range.
"""

from collections.abc import Mapping
from dataclasses import dataclass
import math
from pathlib import Path
from typing import Any, Final, final

from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.files import find_file, list_shipped_names, load_yaml, validate_content
from lta_config.quantity import describe_misfit, Quantity, UNITS
from lta_config.schema.vehicle_body import HullBlock
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.vehicle_edit import format_inline
from lta_model import hull, limits
from lta_model.vehicle import HELIUM_TO_AIR, Vehicle
from lta_sim.wind_limits import rise_speed
from lta_vehicle.new_vehicle import check_vehicle_name, write_new_file
from pydantic import ValidationError

GIVEN: Final = 'given to lta vehicle new'
MOTORS: Final = {
    2: 'one on each side pushing forward, none up',
    3: 'one on each side pushing forward, one in the middle pushing up',
    4: 'one on each side pushing forward, and two pushing up',
}
FILM: Final = 0.045  # kg/m2, of a foil or film envelope with seams
PURITY: Final = 93.0  # %
CLEARANCE: Final = 0.03  # m, from the envelope to the gondola
LEGS: Final = 0.05  # m, from the motors to the ground
AIR: Final = (1.2, 1.5e-5)  # kg/m3 and m2/s at 20 degC, as in lta cfd run
DONOR: Final = 'blimp2b'  # of the assumed battery and loads
HALF_TO_TWICE: Final = 'an estimate; half to twice'
LEAN: Final = math.radians(20.0)  # largest tilt under forward thrust
# Quantities that are asked for: unit, limits
LIMITS: Final[Mapping[str, tuple[str, float, float]]] = {
    'length': ('m', 0.1, 50.0),
    'height': ('m', 0.1, 50.0),
    'diameter': ('m', 0.1, 20.0),
    'mass': ('kg', 0.01, 100.0),
    'thrust': ('N', 1e-3, 100.0),
    'arm': ('m', 0.01, 4.9),
    'hang': ('m', 0.01, 4.9),
    'envelope': ('kg', 1e-3, 100.0),
    'heaviness': ('kg', -0.1, 1.0),
    'battery': ('C', 1.0, 1e6),
}


@final
@dataclass(frozen=True, slots=True)
class VehicleSize:
    """
    What is known of a new vehicle, in SI; None where a value is assumed.

    Attributes
    ----------
    length, height, diameter : float
        Envelope: a cigar along x has a length, a flattened balloon a height, a sphere neither. [m]
    mass : float
        Everything without gas and ballast. [kg]
    motors, thrust : int, float
        Number of motors, and thrust of each at full duty. [N]
    arm, hang : float
        Distance of the side motors from the middle, and of gondola and motors below the centre of
        the envelope. [m]
    envelope : float
        Mass of the empty envelope. [kg]
    heaviness : float
        Weight less lift, with ballast. [kg]
    battery : float
        Charge of the battery. [C]

    """

    diameter: float
    mass: float
    motors: int
    thrust: float
    arm: float
    length: float | None = None
    height: float | None = None
    hang: float | None = None
    envelope: float | None = None
    heaviness: float | None = None
    battery: float | None = None


def parse_size(name: str, text: str) -> float:
    """Return a quantity such as '1.2m' in SI; raise `BadInput` if it is not one for `name`."""
    unit, low, high = LIMITS[name]
    known = [word for word, (kind, _) in UNITS.items() if kind == unit]
    try:
        # Capacities are written without the space of the unit
        quantity = Quantity.model_validate(text.replace('Ah', 'A h'))
    except ValidationError:
        raise BadInput(
            f"--{name} is '{text}'; write a number and a unit ({', '.join(known)}), such as "
            f"'{0.5 * (low + min(high, 10.0)):.2g} {known[0]}'."
        ) from None
    if complaint := describe_misfit(quantity, unit, low, high):
        raise BadInput(f'--{name} {complaint}.')
    return quantity.si


def write_sized_vehicle(name: str, size: VehicleSize, out: Path) -> tuple[Vehicle, Path]:
    """
    Write a vehicle file and, beside it, its gains; return the vehicle and the gains file.

    Raises
    ------
    BadInput
        If the vehicle cannot fly, or a file exists or cannot be written.

    """
    check_vehicle_name(name)
    if name in list_shipped_names('vehicles'):
        raise BadInput(f'{name} is the name of a shipped vehicle; choose another one.')
    gains = out.with_name(f'{name}.gains.yaml')
    blocks = build_blocks(name, size, gains.name)
    vehicle = Vehicle(validate_content(VehicleFile, blocks, f'The vehicle {name}'))
    _ = vehicle.hover_duty  # raises BadInput if the motors cannot lift it
    if gains.exists() or gains == out:
        raise BadInput(f'{gains} already exists; choose another file with --out.')
    texts = format_vehicle_file(blocks, vehicle, size), format_gains(vehicle)
    write_new_file(out, texts[0])
    try:
        write_new_file(gains, texts[1])
    except BadInput:
        out.unlink()
        raise
    return vehicle, gains


def build_blocks(name: str, size: VehicleSize, gains: str) -> dict[str, Any]:
    """Return the content of the vehicle file; raise `BadInput` for an impossible size."""
    envelope = _build_hull(size)
    shape = HullBlock.model_validate(envelope)
    across, depth = (2.0 * hull.half_axes(shape)[axis] for axis in (1, 2))
    hang = 0.5 * depth + CLEARANCE if size.hang is None else size.hang
    film = _find_envelope_mass(size, hull.half_axes(shape))
    lift = hull.hull_volume(shape) * AIR_DENSITY * PURITY / 100.0 * (1.0 - HELIUM_TO_AIR)
    gondola = [0.1, 2.0 * size.arm, 0.03]
    return {
        'schema': 3,
        'name': name,
        'about': f'{1e3 * size.mass:.4g} g without gas; motors: {MOTORS[size.motors]}.',
        'control': {
            'law': 'cascade',
            'gains': gains,
            'source': 'computed from mass, inertia and thrust by lta vehicle new; not tuned',
        },
        'hull': envelope,
        'trim': _build_trim(size, lift, hang),
        'layers': {
            'hull': {
                'envelope': {
                    'shape': 'shell',
                    'mass': film,
                    'position': _cite([0, 0, 0], 'm', 'definition of the origin'),
                    'size': _cite(
                        [2.0 * half for half in hull.half_axes(shape)], 'm', 'as the hull'
                    ),
                }
            },
            'gondola': {
                'gondola': {
                    'shape': 'box',
                    'mass': _cite(
                        1e3 * size.mass - film['value'], 'g', '--mass less the envelope'
                    ),
                    'position': _describe_hang(size, [0, 0, -hang], 0.03),
                    'size': _assume(
                        gondola, 'm', 'assumed: spans the motors', 'a third either way', 1.5
                    ),
                }
            },
        },
        'rotors': _build_rotors(size, hang),
        'aero': _estimate_drag(shape, hang, gondola),
        'effects': {
            'motor_lag': {
                key: _assume(72, 'ms', 'assumed: Crazyflie motors, Eschmann 2024', HALF_TO_TWICE)
                for key in ('up', 'down')
            },
            'floor_contact': {
                'stiffness': _assume(20, 'N/m', 'assumed: soft legs', HALF_TO_TWICE),
                'relaxation': _assume(0.2, 's', 'assumed: lands without bouncing', HALF_TO_TWICE),
                'friction': _assume(0.5, '1', 'assumed', HALF_TO_TWICE),
                'x': _cite(0, 'm', 'assumed: below the hull centre'),
                'y': _cite(0, 'm', 'assumed: below the hull centre'),
                'z': _cite(-hang - LEGS, 'm', 'assumed: 5 cm below the motors'),
            },
        },
        'sensors': _build_sensors(hang, 0.5 * depth, min(0.07, 0.5 * across)),
        'energy': _build_energy(size),
    }


def _cite(value: Any, unit: str, source: str) -> dict[str, Any]:  # noqa: ANN401 - number or list
    """Return a quantity, with four digits."""
    return {'value': _round(value), 'unit': unit, 'source': source}


def _assume(
    value: Any,  # noqa: ANN401 - number or list
    unit: str,
    source: str,
    cause: str,
    factor: float = 2.0,
) -> dict[str, Any]:
    """Return a quantity with a range of a factor either way."""
    ends = [_scale(value, 1.0 / factor), _scale(value, factor)]
    return _cite(value, unit, source) | {'range': _round(ends), 'range_source': cause}


def _scale(value: Any, factor: float) -> Any:  # noqa: ANN401 - number or list
    return [_scale(each, factor) for each in value] if isinstance(value, list) else value * factor


def _round(value: Any) -> Any:  # noqa: ANN401 - number or list
    if isinstance(value, list):
        return [_round(each) for each in value]
    short = float(f'{value:.4g}') + 0.0  # no -0.0
    return int(short) if short.is_integer() else short


def _build_hull(size: VehicleSize) -> dict[str, Any]:
    if size.length is not None and size.height is not None:
        raise BadInput(
            'An envelope has either --length (a cigar) or --height (a flattened balloon); leave '
            'one out.'
        )
    along = size.length or size.height
    shape = {'shape': 'sphere'} if along is None else {
        'shape': 'spheroid', 'axis': 'x' if size.length else 'z',
        'length': _cite(along, 'm', GIVEN),
    }  # fmt: skip
    return {
        **shape,
        'diameter': _cite(size.diameter, 'm', GIVEN),
        'purity': _cite(PURITY, '%', 'assumed: the gas of GT-MAB')
        | {'range': [88, 98], 'range_source': 'party helium to a fresh filling'},
    }  # fmt: skip


def _find_envelope_mass(size: VehicleSize, half: tuple[float, float, float]) -> dict[str, Any]:
    """Return the mass of the empty envelope: given, or of a film of its area. [g]"""
    if size.envelope is not None:
        if size.envelope >= size.mass:
            raise BadInput(
                f'--envelope is {1e3 * size.envelope:g} g and --mass {1e3 * size.mass:g} g; '
                '--mass is everything without gas, the envelope included.'
            )
        return _cite(1e3 * size.envelope, 'g', GIVEN)
    a, b, c = half
    p = 1.6075  # Thomsen's formula for the area of an ellipsoid, within 1.1 %
    mean = ((a * b) ** p + (a * c) ** p + (b * c) ** p) / 3.0
    area = 4.0 * math.pi * mean ** (1.0 / p)
    # An envelope of more than two thirds leaves too little for motors and battery
    film = 1e3 * min(FILM * area, size.mass * 2.0 / 3.0)
    return _cite(
        film, 'g', f'assumed: {area:.3g} m2 of 45 g/m2, at most two thirds of --mass'
    )  # fmt: skip


def _build_trim(size: VehicleSize, lift: float, hang: float) -> dict[str, Any]:
    """Return the trim: ballast up to the heaviness, or none where it is too heavy for any."""
    # Motors that do not push up need a vehicle that floats
    usual = 0.0 if size.motors == 2 else 0.002
    heaviness = usual if size.heaviness is None else size.heaviness
    if size.mass <= lift + heaviness:
        return {
            'heaviness': _cite(1e3 * heaviness, 'g', GIVEN)
            if size.heaviness is not None
            else _cite(1e3 * usual, 'g', 'assumed: trimmed with ballast')
            | {'range': [1e3 * usual - 2, 1e3 * usual + 2], 'range_source': 'trimmed by eye'},
            'ballast_position': _describe_hang(size, [0, 0, -hang], 0.03),
        }
    if size.heaviness is not None:
        raise BadInput(
            f'It weighs {1e3 * size.mass:.4g} g and its gas lifts {1e3 * lift:.4g} g, so it is '
            f'{1e3 * (size.mass - lift):.3g} g heavier than air and cannot be trimmed to '
            f'{1e3 * size.heaviness:g} g; leave out --heaviness, or check mass and size.'
        )
    if size.motors == 2:
        raise BadInput(
            f'It weighs {1e3 * size.mass:.4g} g, its gas lifts {1e3 * lift:.4g} g, and no motor '
            'pushes up; make it lighter or larger, or give --motors 3.'
        )
    return {'ballast': 'none'}


def _describe_hang(size: VehicleSize, place: list[float], spread: float) -> dict[str, Any]:
    """Return a place in the gondola; assumed with a range unless its height was given."""
    if size.hang is not None:
        return _cite(place, 'm', GIVEN)
    low, high = ([*place[:2], place[2] + change] for change in (-spread, spread))
    return _cite(place, 'm', 'assumed: 3 cm below the envelope') | {
        'range': _round([low, high]),
        'range_source': 'how deep the gondola hangs; 3 cm either way',
    }  # fmt: skip


def _build_rotors(size: VehicleSize, hang: float) -> dict[str, Any]:
    """Return the rotors of a standard arrangement (`MOTORS`)."""
    places = {'left': (size.arm, [1, 0, 0]), 'right': (-size.arm, [1, 0, 0])}
    if size.motors == 3:
        places['up'] = (0.0, [0, 0, 1])
    elif size.motors == 4:
        places |= {'up_left': (size.arm, [0, 0, 1]), 'up_right': (-size.arm, [0, 0, 1])}
    # Shares of the Crazyflie's curve 0.0915 u^2 + 0.0677 u
    share, cause = 0.575, 'from a linear to a quadratic curve'
    curve = {
        'a': _cite(share * size.thrust, 'N', '--thrust; its curve assumed as of GT-MAB'),
        'b': _cite((1.0 - share) * size.thrust, 'N', '--thrust; its curve assumed as of GT-MAB'),
    }
    for key, ends in (('a', (0.0, 0.95)), ('b', (1.0, 0.05))):
        curve[key] |= {
            'range': _round([end * size.thrust for end in ends]), 'range_source': cause,
        }  # fmt: skip
    return {
        name: {
            'reversible': True,
            'position': _describe_hang(size, [0, y, -hang], 0.03),
            'axis': _cite(axis, '1', f'assumed: {MOTORS[size.motors]}'),
            'thrust_curve': curve,
        }
        for name, (y, axis) in places.items()
    }


def _estimate_drag(shape: HullBlock, hang: float, gondola: list[float]) -> dict[str, Any]:
    """Return the drag of envelope and gondola by the formulas of `lta_sim.cfd.analytic`."""
    # Imported late: the surfaces need trimesh, which copying a file does not
    from lta_sim.cfd.aero_fit import opposing_drag
    from lta_sim.cfd.drag_fit import fit_drag
    from lta_sim.cfd.shape import build_hull_surface
    from lta_sim.cfd.solve import estimate_drag
    from lta_sim.cfd.tunnel_model import build_box_surface, HULL, TunnelModel

    box = build_box_surface((0.0, 0.0, -hang), (gondola[0], gondola[1], gondola[2]))
    model = TunnelModel('sized', {HULL: build_hull_surface(shape), 'gondola': box}, {}, {})
    fits = [
        fit_drag([point.speed for point in points], opposing_drag(axis, points))
        for axis, points in estimate_drag(model, AIR).items()
    ]
    along = 'lta cfd, analytic: Hoerner 1965 for the envelope, a plate for the gondola; no fins'
    about = 'lta cfd, analytic: laminar disc and plate; no fins'
    return {
        f'{term}_drag': {
            'force': _assume(
                [getattr(fit, term) for fit in fits[:3]], force, f'assumed: {along}', HALF_TO_TWICE
            ),
            'moment': _assume(
                [getattr(fit, term) for fit in fits[3:]], moment, f'assumed: {about}',
                HALF_TO_TWICE,
            ),
        }
        for term, force, moment in (
            ('linear', 'N s/m', 'N m s'),
            ('quadratic', 'N s2/m2', 'N m s2'),
        )
    }  # fmt: skip


def _build_sensors(hang: float, top: float, radius: float) -> dict[str, Any]:
    senses = 'assumed: the senses of GT-MAB, in the gondola; only lamp-seeking flights need them'
    below = _cite([0, 0, -hang], 'm', senses)
    return {
        'imu_position': below,
        'range_position': below,
        'panel_position': _cite([0, 0, top], 'm', 'assumed: on top; no solar panel'),
        'diodes': {
            'count': 8,
            'radius': _cite(radius, 'm', senses),
            'height': _cite(-hang, 'm', senses),
            'feedback': _cite(100, 'kohm', senses),
        },
    }


def _build_energy(size: VehicleSize) -> dict[str, Any]:
    """Return the assumed battery and loads of another small blimp, with the given capacity."""
    block: dict[str, Any] = load_yaml(find_file('vehicle', DONOR))['energy']
    battery, loads = dict(block['battery']), dict(block['loads'])
    if size.battery is not None:
        battery['capacity'] = _cite(size.battery / 3.6, 'mA h', GIVEN)
        battery['charge_current'] = _cite(size.battery / 3.6, 'mA', 'assumed: 1 C')
    for key, cause in (
        ('idle', 'a receiver to a small computer'),
        ('rotor_idle', 'motors of other sizes'),
        ('rotor_power', 'motors and propellers of other sizes'),
    ):
        held = loads[key]
        loads[key] = _assume(
            held['value'], held['unit'], f'assumed: {held["source"].removeprefix("assumed: ")}',
            f'{cause}; half to twice',
        )  # fmt: skip
    return {'battery': battery, 'loads': loads}


def format_vehicle_file(blocks: Mapping[str, Any], vehicle: Vehicle, size: VehicleSize) -> str:
    """Return the text of the vehicle file, with what follows from it as comments."""
    added = vehicle.added_mass
    cm = f'{100.0 * -vehicle.cg[2]:.1f}'
    gas = f'{1e3 * vehicle.gross_lift:.1f} g lift of {vehicle.volume:.4g} m3'
    ballast = (
        f'{1e3 * vehicle.ballast_mass:.1f} g of ballast make it {1e3 * vehicle.heaviness:.2g} g '
        'heavier than air'
        if 'heaviness' in blocks['trim']
        else f'{1e3 * vehicle.heaviness:.3g} g heavier than air, which the motors carry'
    )
    inertia = ', '.join(f'{each:.3g}' for each in vehicle.inertia.diagonal())
    masses = ', '.join(f'{1e3 * each:.3g}' for each in added[:3])
    head = [
        f'# {vehicle.file.name}: written by lta vehicle new from size, mass and motors.',
        '#',
        '# What follows from the numbers below (lta vehicle show computes it anew):',
        f'#   gas        {gas}; {size.mass * 1e3:.4g} g without gas',
        f'#   balance    {ballast}; centre of gravity {cm} cm below the hull centre',
        f'#   inertia    {inertia} kg m2 about x, y, z: envelope, gondola, ballast and gas',
        f'#   added mass {masses} g along x, y, z (Lamb 1932, spheroid)',
        '#',
        '# Weigh and measure first what has the source "assumed" and a wide range: the envelope',
        '# alone, the depth of the gondola, the thrust of a motor at full and half duty. What a',
        '# scale does not tell, flights do: lta tests plan.',
    ]
    lines = [*head]
    for key, block in blocks.items():
        lines += ['', *_format_block(key, block, '')] if isinstance(block, dict) else (
            [f'{key}: {format_inline(block)}']
        )  # fmt: skip
    return '\n'.join(lines) + '\n'


def _format_block(key: str, block: Any, indent: str) -> list[str]:  # noqa: ANN401 - as YAML has it
    """Return a block as lines: a quantity or a word on one, a mapping below its key."""
    if not isinstance(block, dict) or 'unit' in block or not block:
        return [f'{indent}{key}: {format_inline(block)}']
    below = [
        line for name, each in block.items() for line in _format_block(name, each, indent + '  ')
    ]
    return [f'{indent}{key}:', *below]


def format_gains(vehicle: Vehicle) -> str:
    """
    Return a file of gains for the cascade, scaled to mass, inertia and thrust.

    The bandwidths (1/s) are those of the hand-tuned gains of GT-MAB and Blimp2b, rounded: 0.65 in
    heave, 2 in yaw, 0.4 in surge. Limits leave each axis a share of the thrust that the others
    keep.
    """
    m, added = vehicle.mass, vehicle.added_mass
    surge, heave = m + added[0], m + added[2]
    turn = float(vehicle.inertia[2, 2]) + added[5]
    columns = [(rotor.column, rotor.full_thrust) for rotor in vehicle.rotors]
    up = sum(max(column[2], 0.0) * full for column, full in columns)
    ahead = sum(max(column[0], 0.0) * full for column, full in columns)
    yaw = sum(abs(column[5]) * full for column, full in columns)
    depth = float(-vehicle.cg[2])
    lowest = max(-rotor.place[2] for rotor in vehicle.rotors)
    # The forward thrust that the righting moment holds at the largest tilt
    level = m * STANDARD_GRAVITY * depth * math.sin(LEAN) / lowest
    push = min(0.5 * ahead, level)
    drag = vehicle.file.aero.quadratic_drag.force.vector[0]
    # Without a motor that holds it down it rises at any speed, so that is no limit
    rise = rise_speed(vehicle) if up else math.inf
    top = min(math.sqrt(push / drag), limits.tumble_speed(vehicle), rise, 2.0)
    lines = [
        'altitude_kp: 0.4',
        'climb_limit: 0.15',
        f'climb: {_format_loop(0.65 * heave, 0.2, 0.65 * up)}',
        'heading_kp: 0.5',
        'yaw_rate_limit: 0.5',
        f'yaw_rate: {_format_loop(2.0 * turn, 0.25, 0.25 * yaw)}',
        f'speed: {_format_loop(0.4 * surge, 0.1, push)}',
        'turn_first: 0.9',
        'drift_gain: 1.0',
        'drift_limit: 0.6',
        f'speed_limit: {_round(max(0.9 * top, 0.05))}',
        'rise_limit: 0.4',
        f'swing_gain: {_round(0.2 * surge)}',
    ]
    head = (
        f'# Gains of the cascade for {vehicle.file.name}, computed from mass, inertia and thrust '
        'by lta vehicle new: assumed.\n# Tune them with lta tune, and name the new file in '
        'control.gains of the vehicle file.\n'
    )
    return head + '/**/controller:\n  ros__parameters:\n    gains:\n' + ''.join(
        f'      {line}\n' for line in lines
    )  # fmt: skip


def _format_loop(kp: float, integral: float, limit: float) -> str:
    return f'{{kp: {_round(kp)}, ki: {_round(integral * kp)}, kd: 0.0, limit: {_round(limit)}}}'
