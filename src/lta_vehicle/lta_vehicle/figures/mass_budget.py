# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Derive mass, lift, centre of gravity and inertia of a vehicle."""

from collections.abc import Iterator
import math
from typing import final, NamedTuple

from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure

WEIGHT, BALANCE_GROUP = 'Weight and lift', 'Balance'
GRAMS, CENTIMETRES, DEGREES = 1e3, 1e2, 180.0 / math.pi
PART_BLOCKS = ('layers', 'measured', 'moving_mass')
HULL_BLOCKS = ('hull',)
ALL_BLOCKS = (*PART_BLOCKS, *HULL_BLOCKS, 'trim')


@final
class MassBudgetItem(NamedTuple):
    """A part in the mass budget, with its mass in kg."""

    layer: str
    part: str
    mass: float
    source: str


def build_mass_budget(vehicle: Vehicle) -> list[MassBudgetItem]:
    """Return the parts of the vehicle with their masses, in file order."""
    file = vehicle.file
    rows = []
    # A vehicle weighed as a whole has no masses of its parts
    if file.measured:
        rows.append(
            MassBudgetItem(
                'measured',
                'whole vehicle, gas included',
                file.measured.mass.si,
                file.measured.mass.source or '',
            )
        )
    else:
        for layer, parts in file.layers.items():
            for name, part in parts.items():
                rows.append(MassBudgetItem(layer, name, part.mass.si, part.mass.source or ''))
        if vehicle.ballast_mass:
            rows.append(
                MassBudgetItem(
                    'ballast', 'ballast', vehicle.ballast_mass, 'follows from trim.heaviness'
                )
            )
    if file.moving_mass:
        rows.append(
            MassBudgetItem(
                'moving mass',
                'moving mass',
                file.moving_mass.mass.si,
                file.moving_mass.mass.source or '',
            )
        )
    # A weighed vehicle includes its gas
    if not file.measured and vehicle.gas_mass:
        rows.append(
            MassBudgetItem(
                'gas',
                'helium and the air in it',
                vehicle.gas_mass,
                'volume and purity of the hull',
            )
        )
    return rows


def derive_weight_figures(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    """Yield the figures of the group 'Weight and lift'."""
    file, weighed = vehicle.file, vehicle.file.measured is not None
    hull = file.hull.shape != 'none'
    rule = 'weighed' if weighed else 'sum of parts, ballast and gas'
    words = 'mass, gas included' if hull else 'mass'
    yield DerivedFigure('mass', WEIGHT, words, GRAMS * vehicle.mass, 'g', rule, ALL_BLOCKS)
    if hull:
        yield _derive_displaced_air(vehicle)
    if hull and not weighed:
        rule, lift = (
            'volume, purity and the densities of air and helium',
            GRAMS * vehicle.gross_lift,
        )
        yield DerivedFigure('lift', WEIGHT, 'gross lift of the gas', lift, 'g', rule, HULL_BLOCKS)
    rule, heavy = 'mass minus displaced air', GRAMS * vehicle.heaviness
    if file.trim.heaviness:
        rule = 'trim.heaviness'
    note = 'carried by the rotors'
    yield DerivedFigure(
        'heaviness', WEIGHT, 'heavier than air by', heavy, 'g', rule, ('trim',), 2, note
    )
    if file.trim.ballast_position:
        rule, ballast = (
            'gross lift plus heaviness minus mass of the parts',
            GRAMS * vehicle.ballast_mass,
        )
        note = 'weigh the finished vehicle in flight with lta vehicle trim'
        yield DerivedFigure(
            'ballast', WEIGHT, 'ballast to add', ballast, 'g', rule, ALL_BLOCKS, note=note
        )


def _derive_displaced_air(vehicle: Vehicle) -> DerivedFigure:
    """Return the mass of the displaced air."""
    weighed = vehicle.file.measured is not None
    rests = ALL_BLOCKS if weighed else HULL_BLOCKS
    rule = f'volume times air density ({vehicle.air_density:.4g} kg/m³)'
    if weighed:
        rule = 'mass minus heaviness'
    note, mass = f'hull volume: {1e3 * vehicle.volume:.0f} l', GRAMS * vehicle.displaced_mass
    return DerivedFigure('displaced', WEIGHT, 'air displaced', mass, 'g', rule, rests, note=note)


def derive_balance_figures(vehicle: Vehicle) -> Iterator[DerivedFigure]:
    """Yield the figures of the group 'Balance': centres, inertia and added mass."""
    x, y, z = (CENTIMETRES * float(number) for number in vehicle.cg)
    rule = 'measured as a whole' if vehicle.file.measured else 'sum of parts, ballast and gas'
    words, note = 'CG below CB', 'CG: centre of gravity, CB: centre of buoyancy (hull centre)'
    if vehicle.file.hull.shape == 'none':
        words, note = 'CG below the origin', 'no hull, so no righting moment'
    yield DerivedFigure('cg_depth', BALANCE_GROUP, words, -z, 'cm', rule, ALL_BLOCKS, 2, note)
    yield DerivedFigure(
        'cg_x', BALANCE_GROUP, 'CG ahead of the hull centre', x, 'cm', rule, ALL_BLOCKS, 2
    )
    yield DerivedFigure(
        'cg_y', BALANCE_GROUP, 'CG left of the hull centre', y, 'cm', rule, ALL_BLOCKS, 2
    )
    if vehicle.file.hull.shape != 'none':
        # With the CG above the CB there is no stable attitude, hence no lean
        if z < 0.0:
            # At rest, the line from CB to CG is vertical
            lean = math.atan2(math.hypot(x, y), -z) * DEGREES
            rule_of = 'the centre of gravity is vertically below the centre of buoyancy'
            yield DerivedFigure(
                'lean', BALANCE_GROUP, 'tilt at rest', lean, '°', rule_of, ALL_BLOCKS
            )
        yield derive_pressure_center(vehicle)
    for i, axis in enumerate(('roll', 'pitch', 'yaw')):
        own = 1e3 * float(vehicle.inertia[i, i])
        words = f'moment of inertia in {axis}, about the CG'
        yield DerivedFigure(
            f'inertia_{axis}', BALANCE_GROUP, words, own, 'g m²', rule, ALL_BLOCKS, 3
        )
    if any(vehicle.added_mass):
        rule = 'as published' if vehicle.file.hull.added_mass else 'Lamb 1932, spheroid'
        for i, axis in enumerate('xyz'):
            air, words = GRAMS * vehicle.added_mass[i], f'added mass of air along {axis}'
            yield DerivedFigure(
                f'added_mass_{axis}', BALANCE_GROUP, words, air, 'g', rule, HULL_BLOCKS
            )


def derive_pressure_center(vehicle: Vehicle) -> DerivedFigure:
    """
    Return the centre of pressure.

    The aero block and the drag of parts act at the hull centre. With `hull_lift`, the centre of
    pressure is the slope of the pitch moment divided by that of the lift.
    """
    wing = vehicle.collect_effects().get('hull_lift')
    # Without lift slope the quotient below is undefined
    if wing and wing['lift_alpha']:
        ahead = wing['pitch_alpha'] / wing['lift_alpha']
        rule, place = (
            'slope of the pitch moment divided by slope of the lift, both over angle of attack',
            'effects.hull_lift',
        )
    else:
        ahead, rule, place = 0.0, 'the aero block acts at the hull centre', 'aero'
    note = 'at the hull centre' if ahead == 0.0 else ''
    return DerivedFigure(
        'cp_x',
        BALANCE_GROUP,
        'centre of pressure ahead of hull centre',
        CENTIMETRES * ahead,
        'cm',
        rule,
        (place,),
        2,
        note,
    )
