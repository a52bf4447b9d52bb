"""What a vehicle weighs, what carries it, and where its weight hangs."""

from collections.abc import Iterator
import math
from typing import final, NamedTuple

from lta_analysis.vehicle.figure import Figure
from lta_sim.vehicle import Vehicle

WEIGHT, BALANCE = 'Weight and lift', 'Balance'
GRAMS, CENTIMETRES, DEGREES = 1e3, 1e2, 180.0 / math.pi
PARTS = ('layers', 'measured', 'moving_mass')
HULL = ('hull',)
ALL = (*PARTS, *HULL, 'trim')


@final
class Share(NamedTuple):
    """One line of the mass budget: layer, part, mass [kg], and the source of that mass."""

    layer: str
    part: str
    mass: float
    source: str


def budget(vehicle: Vehicle) -> list[Share]:
    """Return what the vehicle's mass is made of, in the order of its file."""
    file = vehicle.file
    rows = []
    if file.measured:
        rows.append(
            Share(
                'measured',
                'whole vehicle, gas included',
                file.measured.mass.si,
                file.measured.mass.source or '',
            )
        )
    else:
        for layer, parts in file.layers.items():
            for name, part in parts.items():
                rows.append(Share(layer, name, part.mass.si, part.mass.source or ''))
        if vehicle.ballast:
            rows.append(
                Share('ballast', 'ballast', vehicle.ballast, 'what trim.heaviness asks for')
            )
    if file.moving_mass:
        rows.append(
            Share(
                'moving mass',
                'moving mass',
                file.moving_mass.mass.si,
                file.moving_mass.mass.source or '',
            )
        )
    if not file.measured and vehicle.gas:
        rows.append(
            Share('gas', 'helium and the air in it', vehicle.gas, 'volume and purity of the hull')
        )
    return rows


def weight_figures(vehicle: Vehicle) -> Iterator[Figure]:
    """Yield what it weighs and what carries it."""
    file = vehicle.file
    weighed = file.measured is not None
    yield Figure(
        'mass',
        WEIGHT,
        'mass, gas included' if file.hull.shape != 'none' else 'mass',
        GRAMS * vehicle.mass,
        'g',
        'weighed' if weighed else 'parts, ballast and gas, summed',
        ALL,
    )
    if file.hull.shape != 'none':
        yield Figure(
            'displaced',
            WEIGHT,
            'air displaced',
            GRAMS * vehicle.displaced,
            'g',
            'mass less heaviness: filled until it is right'
            if weighed
            else f'volume times {vehicle.air_density:.4g} kg/m3 of air',
            ALL if weighed else HULL,
            note=f'hull of {1e3 * vehicle.volume:.0f} l',
        )
    if file.hull.shape != 'none' and not weighed:
        yield Figure(
            'lift',
            WEIGHT,
            'gross lift of the gas',
            GRAMS * vehicle.lift,
            'g',
            'volume, purity and the densities of air and helium',
            HULL,
        )
    yield Figure(
        'heaviness',
        WEIGHT,
        'heavier than air by',
        GRAMS * vehicle.heaviness,
        'g',
        'trim.heaviness' if file.trim.heaviness else 'mass less displaced air',
        ('trim',),
        digits=2,
        note='what the rotors carry',
    )
    if file.trim.ballast_position:
        yield Figure(
            'ballast',
            WEIGHT,
            'ballast to add',
            GRAMS * vehicle.ballast,
            'g',
            'lift and heaviness less parts',
            ALL,
            note='weigh the finished vehicle: see lta vehicle trim',
        )


def balance_figures(vehicle: Vehicle) -> Iterator[Figure]:
    """Yield where the weight hangs, and what it takes to turn and to push it."""
    x, y, z = (float(number) for number in vehicle.cg)
    rule = 'swung as a whole' if vehicle.file.measured else 'parts, ballast and gas, summed'
    hull = vehicle.file.hull.shape != 'none'
    if hull:
        yield Figure(
            'cg_depth',
            BALANCE,
            'CG below CB',
            -CENTIMETRES * z,
            'cm',
            rule,
            ALL,
            2,
            'CB is the hull centre',
        )
    else:
        yield Figure(
            'cg_depth',
            BALANCE,
            'CG below the origin',
            -CENTIMETRES * z,
            'cm',
            rule,
            ALL,
            2,
            'no hull, so nothing rights it',
        )
    yield Figure('cg_x', BALANCE, 'CG ahead of the centre', CENTIMETRES * x, 'cm', rule, ALL, 2)
    yield Figure('cg_y', BALANCE, 'CG left of the centre', CENTIMETRES * y, 'cm', rule, ALL, 2)
    if hull and z < 0.0:
        lean = math.atan2(math.hypot(x, y), -z) * DEGREES
        yield Figure(
            'lean',
            BALANCE,
            'hangs off the vertical by',
            lean,
            '°',
            'CG and CB above each other',
            ALL,
        )
    if hull:
        yield pressure(vehicle)
    inertia = vehicle.inertia
    for i, axis in enumerate(('roll', 'pitch', 'yaw')):
        yield Figure(
            f'inertia_{axis}',
            BALANCE,
            f'inertia in {axis}, about the CG',
            1e3 * float(inertia[i, i]),
            'g m²',
            rule,
            ALL,
            3,
        )
    if any(vehicle.added_mass):
        rule = 'as published' if vehicle.file.hull.added_mass else 'Lamb 1932, spheroid'
        for i, axis in enumerate('xyz'):
            yield Figure(
                f'added_mass_{axis}',
                BALANCE,
                f'air that moves with it along {axis}',
                GRAMS * vehicle.added_mass[i],
                'g',
                rule,
                HULL,
            )


def pressure(vehicle: Vehicle) -> Figure:
    """
    Return where the force of the air acts.

    The aero block and the drag of parts act at the hull centre. `hull_lift` has a moment of its
    own: its centre is the pitch moment by angle of attack over the lift by it (N m a newton).
    """
    wing = vehicle.effects().get('hull_lift')
    if wing and wing['lift_alpha']:
        ahead = wing['pitch_alpha'] / wing['lift_alpha']
        rule, place = 'pitch moment by angle of attack over lift', 'effects.hull_lift'
    else:
        ahead, rule, place = 0.0, 'the aero block is about the hull centre', 'aero'
    note = 'at the hull centre' if ahead == 0.0 else ''
    return Figure(
        'cp_x',
        BALANCE,
        'centre of pressure ahead of the centre',
        CENTIMETRES * ahead,
        'cm',
        rule,
        (place,),
        2,
        note,
    )
