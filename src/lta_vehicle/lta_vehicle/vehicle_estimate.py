# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate the content of a vehicle file from size, mass and motors.

The drag is estimated by hand (`lta_windtunnel.analytic`). What is neither given nor follows is
assumed, and marked so, with its range.
"""

from dataclasses import dataclass
import math
from typing import Any, Final, final

from lta_config.constants import AIR_DENSITY
from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_config.schema.vehicle_body import HullBlock
from lta_model import mass_properties

MOTOR_LAYOUTS: Final = {
    2: 'one on each side pushing forward, none up',
    3: 'one on each side pushing forward, one in the middle pushing up',
    4: 'one on each side pushing forward, and two pushing up',
}


@final
@dataclass(frozen=True, slots=True)
class VehicleSize:
    """What is known of a new vehicle, in SI; None where a value is assumed."""

    # Envelope: a cigar along x has a length, a flattened balloon a height, a sphere neither [m]
    diameter: float
    mass: float  # everything without gas and ballast [kg]
    motors: int  # number of motors
    thrust: float  # of each motor at full duty [N]
    arm: float  # distance of the side motors from the middle [m]
    length: float | None = None  # [m]
    height: float | None = None  # [m]
    hang: float | None = None  # of gondola and motors below the centre of the envelope [m]
    envelope: float | None = None  # mass of the empty envelope [kg]
    heaviness: float | None = None  # weight less lift, with ballast [kg]
    battery: float | None = None  # charge of the battery [C]


GIVEN_SOURCE: Final = 'given to lta vehicle new'
FILM: Final = 0.045  # kg/m2, of a foil or film envelope with seams
PURITY: Final = 93.0  # %
GONDOLA_CLEARANCE: Final = 0.03  # m, from the envelope to the gondola
TURNING_GAS: Final = 0.09  # m; diameter times the share of the gas that turns with the hull
LEGS: Final = 0.05  # m, from the motors to the ground
DONOR: Final = 'blimp2b'  # of the assumed battery and loads
HALF_TO_TWICE: Final = 'an estimate; half to twice'


def build_blocks(name: str, size: VehicleSize, gains: str) -> dict[str, Any]:
    """Return the content of the vehicle file; raise `BadInput` for an impossible size."""
    envelope = _build_hull(size)
    shape = HullBlock.model_validate(envelope)
    across, depth = (2.0 * mass_properties.half_axes(shape)[axis] for axis in (1, 2))
    hang = 0.5 * depth + GONDOLA_CLEARANCE if size.hang is None else size.hang
    film = _find_envelope_mass(size, mass_properties.half_axes(shape))
    air = mass_properties.hull_volume(shape) * AIR_DENSITY
    lift = air - mass_properties.gas_mass(shape, AIR_DENSITY)
    gondola = [0.1, 2.0 * size.arm, 0.03]
    return {
        'schema': 3,
        'name': name,
        'about': f'{1e3 * size.mass:.4g} g without gas; motors: {MOTOR_LAYOUTS[size.motors]}.',
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
                        [2.0 * half for half in mass_properties.half_axes(shape)],
                        'm',
                        'as the hull',
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
            'gas_rotation': {
                'share': _assume(
                    min(0.5, TURNING_GAS / size.diameter),
                    '1',
                    'computed: Stokes layer of helium, by 1/diameter as of GT-MAB',
                    HALF_TO_TWICE,
                )
            },
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


def _cite(value: Any, unit: str, source: str) -> dict[str, Any]:
    """Return a quantity, with four digits."""
    return {'value': round_digits(value), 'unit': unit, 'source': source}


def _assume(
    value: Any,
    unit: str,
    source: str,
    cause: str,
    factor: float = 2.0,
) -> dict[str, Any]:
    """Return a quantity with a range of a factor either way."""
    ends = [_scale(value, 1.0 / factor), _scale(value, factor)]
    return _cite(value, unit, source) | {
        'range': round_digits(ends),
        'range_source': cause,
    }


def _scale(value: Any, factor: float) -> Any:
    return [_scale(each, factor) for each in value] if isinstance(value, list) else value * factor


def round_digits(value: Any) -> Any:
    """Return a number, or the numbers of a list, with four digits."""
    if isinstance(value, list):
        return [round_digits(each) for each in value]
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
        'length': _cite(along, 'm', GIVEN_SOURCE),
    }  # fmt: skip
    return {
        **shape,
        'diameter': _cite(size.diameter, 'm', GIVEN_SOURCE),
        'purity': _cite(PURITY, '%', 'assumed: the gas of GT-MAB')
        | {'range': [88, 98], 'range_source': 'party helium to a fresh filling'},
    }  # fmt: skip


def _find_envelope_mass(size: VehicleSize, half: tuple[float, float, float]) -> dict[str, Any]:
    """Return the mass of the empty envelope: given, or of a film of its area [g]."""
    if size.envelope is not None:
        if size.envelope >= size.mass:
            raise BadInput(
                f'--envelope is {1e3 * size.envelope:g} g and --mass {1e3 * size.mass:g} g; '
                '--mass is everything without gas, the envelope included.'
            )
        return _cite(1e3 * size.envelope, 'g', GIVEN_SOURCE)
    a, b, c = half
    p = 1.6075  # Thomsen's formula for the area of an ellipsoid, within 1.1 %
    mean = ((a * b) ** p + (a * c) ** p + (b * c) ** p) / 3.0
    area = 4.0 * math.pi * mean ** (1.0 / p)
    # An envelope of more than two thirds leaves too little for motors and battery
    film = 1e3 * min(FILM * area, size.mass * 2.0 / 3.0)
    return _cite(
        film, 'g', f'assumed: {area:.3g} m2 of {1e3 * FILM:g} g/m2, at most two thirds of --mass'
    )  # fmt: skip


def _build_trim(size: VehicleSize, lift: float, hang: float) -> dict[str, Any]:
    """Return the trim: ballast up to the heaviness, or none where it is too heavy for any."""
    # Motors that do not push up need a vehicle that floats
    usual = 0.0 if size.motors == 2 else 0.002
    heaviness = usual if size.heaviness is None else size.heaviness
    if size.mass <= lift + heaviness:
        return {
            'heaviness': _cite(1e3 * heaviness, 'g', GIVEN_SOURCE)
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
        return _cite(place, 'm', GIVEN_SOURCE)
    low, high = ([*place[:2], place[2] + change] for change in (-spread, spread))
    return _cite(place, 'm', 'assumed: 3 cm below the envelope') | {
        'range': round_digits([low, high]),
        'range_source': 'how deep the gondola hangs; 3 cm either way',
    }  # fmt: skip


def _build_rotors(size: VehicleSize, hang: float) -> dict[str, Any]:
    """Return the rotors of a standard arrangement (`MOTOR_LAYOUTS`)."""
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
            'range': round_digits([end * size.thrust for end in ends]), 'range_source': cause,
        }  # fmt: skip
    return {
        name: {
            'reversible': True,
            'position': _describe_hang(size, [0, y, -hang], 0.03),
            'axis': _cite(axis, '1', f'assumed: {MOTOR_LAYOUTS[size.motors]}'),
            'thrust_curve': curve,
        }
        for name, (y, axis) in places.items()
    }


def _estimate_drag(shape: HullBlock, hang: float, gondola: list[float]) -> dict[str, Any]:
    """Return the drag of envelope and gondola by the formulas of `lta_windtunnel.analytic`."""
    # Imported late: the surfaces need trimesh, which copying a file does not
    from lta_windtunnel.aero_fit import fit_drag, opposing_drag
    from lta_windtunnel.flow_plan import TUNNEL_AIR
    from lta_windtunnel.shape import build_hull_surface
    from lta_windtunnel.solve import estimate_drag
    from lta_windtunnel.tunnel_model import build_box_surface, HULL_PATCH, TunnelModel

    box = build_box_surface((0.0, 0.0, -hang), (gondola[0], gondola[1], gondola[2]))
    model = TunnelModel('sized', {HULL_PATCH: build_hull_surface(shape), 'gondola': box}, {}, {})
    fits = [
        fit_drag([point.speed for point in points], opposing_drag(axis, points))
        for axis, points in estimate_drag(model, TUNNEL_AIR).items()
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
        battery['capacity'] = _cite(size.battery / 3.6, 'mA h', GIVEN_SOURCE)
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
