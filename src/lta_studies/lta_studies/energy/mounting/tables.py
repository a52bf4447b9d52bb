"""Build the tables of the mount comparison: balance, flights and light."""

from typing import Any, Final

from lta_report.formatting import format_number, MISSING
from lta_report.report import TextTable
from lta_studies.energy.mounting.panel_light import LIGHTS
from lta_studies.energy.mounting.run import MountingStudy, MountTrial
from lta_studies.energy.mounting.straight_flight import average_over_seeds
from lta_vehicle.figures.mass_budget import DEGREES

GRAMS: Final = 1e3
CENTIMETRES: Final = 1e2


def build_comparison_tables(study: MountingStudy) -> list[TextTable]:
    """Return every table of the comparison."""
    more = f'hull {100.0 * (study.fuller - 1.0):.1f} % larger'
    own = {f'{name}, own hull': each for name, each in study.own.items()}
    shared = {f'{name}, {more}': each for name, each in study.shared.items()}
    out = f'panels {CENTIMETRES * study.ahead:g} cm too far forward'
    misplaced = {f'{name}, {out}': each for name, each in study.misplaced.items()}
    return [
        build_balance_table(own | shared),
        build_flight_table(own | shared | misplaced),
        build_light_table(study),
    ]


def build_balance_table(entries: dict[str, MountTrial]) -> TextTable:
    """Return the table of mass, balance and swing."""
    heads = ('mount', 'mass [g]', 'ballast [g]', 'CG below CB [cm]', 'inertia, pitch [g m²]',
             'drag, ahead [mN s²/m²]', 'righting [mN m/°]', 'period by hand [s]', 'simulated [s]',
             'damping by hand [%]', 'simulated [%]')  # fmt: skip
    rows = []
    for name, each in entries.items():
        body, swing, free = each.fitted.vehicle, each.swing, each.release
        rows.append([
            name,
            format_number(body.mass, 1, GRAMS),
            format_number(body.ballast_mass, 1, GRAMS),
            format_number(-float(body.cg[2]), 1, CENTIMETRES),
            format_number(float(body.inertia[1, 1]), 1, GRAMS),
            format_number(body.collect_effects()['quadratic_drag']['surge'], 1, 1e3),
            # N m/rad to mN m per degree
            format_number(swing.stiffness, 2, 1e3 / DEGREES),
            format_number(swing.period, 3),
            format_number(free.period, 3),
            format_number(swing.damping_ratio, 3, 100.0),
            format_number(free.damping_ratio, 3, 100.0),
        ])  # fmt: skip
    return TextTable('Balance and swing', heads, rows)


def build_flight_table(entries: dict[str, MountTrial]) -> TextTable:
    """Return the table of flights."""
    heads = ('mount', 'lean at rest [°]', 'swing after lift-off [±°]', 'pitch in flight [±°]',
             'rms pitch [°]', 'hovering [mW]', 'flying [mW]',
             'misplacement for ±2.5° [cm]')  # fmt: skip
    rows = []
    for name, each in entries.items():
        figures = [
            format_seed_mean(each, key, digits, factor)
            for key, digits, factor in (
                ('swing', 2, DEGREES), ('amplitude', 2, DEGREES), ('rms', 3, DEGREES),
                ('hover', 0, 1e3), ('power', 0, 1e3),
            )
        ]  # fmt: skip
        far = (
            format_number(each.misplacement, 1, CENTIMETRES)
            # Only with the panels in place is the misplacement relative to the file's position.
            if each.fitted.ahead == 0.0
            else MISSING
        )
        rows.append([name, format_number(each.fitted.nose_down_pitch, 2, DEGREES), *figures, far])
    return TextTable('Straight flight at 0.1 m/s', heads, rows)


def format_seed_mean(each: MountTrial, key: str, digits: int, factor: float) -> str:
    """Format a mean over flights, with the deviation of single seeds if visible."""
    average = average_over_seeds(each.flights, key)
    off = format_number(average.off, digits, factor)
    text = format_number(average.mean, digits, factor)
    # A deviation that rounds to zero is left out.
    return text if not float(off) else f'{text}\N{PLUS-MINUS SIGN}{off}'


def build_light_table(study: MountingStudy) -> TextTable:
    """Return the table of light on the panels."""
    heads = ['mount', *(f'{light.name} [%]' for light in LIGHTS)]
    rows = []
    for name, shares in study.light.items():
        for words, key in (('in series', 'series'), ('separately', 'apart')):
            cells = [format_number(getattr(each, key), 0, 100.0) for each in shares.values()]
            rows.append([f'{name}, {words}', *cells])
    return TextTable('Light on the panels', heads, rows)


def to_json(study: MountingStudy) -> dict[str, Any]:
    """Convert the comparison to JSON, in SI units."""
    return {
        'vehicle': study.vehicle, 'misplacement': study.ahead, 'fuller': study.fuller,
        'lift_lacking': dict(study.lacking),
        **{
            group: {name: _trial_to_json(each) for name, each in getattr(study, group).items()}
            for group in ('own', 'shared', 'misplaced')
        },
        'overturning': [
            {'cg_height': each.height, 'turned_over_after': each.release.overturn_time,
             'greatest_tilt': float(abs(each.release.tilt).max()), 'growth_by_hand': each.growth}
            for each in study.overturning
        ],
        'light': {
            name: {light: {'series': at.series, 'apart': at.apart} for light, at in shares.items()}
            for name, shares in study.light.items()
        },
    }  # fmt: skip


def _trial_to_json(each: MountTrial) -> dict[str, Any]:
    body = each.fitted.vehicle
    keys = ('swing', 'lean', 'amplitude', 'rms', 'hover', 'power')
    return {
        'mass': body.mass, 'ballast': body.ballast_mass, 'cg': body.cg.tolist(),
        'inertia': body.inertia.tolist(), 'lean_by_hand': each.fitted.nose_down_pitch,
        'stiffness': each.swing.stiffness, 'period_by_hand': each.swing.period,
        'period': each.release.period, 'damping_by_hand': each.swing.damping_ratio,
        'damping': each.release.damping_ratio, 'misplacement_for_paper': each.misplacement,
        **{key: average_over_seeds(each.flights, key).mean for key in keys},
    }  # fmt: skip
