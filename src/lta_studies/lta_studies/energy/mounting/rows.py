"""The comparison of mounts as tables of text: what follows from the place, flights, light."""

from typing import Any, Final

from lta_report.formatting import MISSING, number
from lta_studies.energy.mounting.lit import LIGHTS
from lta_studies.energy.mounting.run import Study, Tried
from lta_studies.energy.mounting.straight import over
from lta_studies.energy.tables import Table
from lta_vehicle.figures.weighing import DEGREES

GRAMS: Final = 1e3
CENTIMETRES: Final = 1e2


def tables(study: Study) -> list[Table]:
    """Return every table of the comparison."""
    more = f'{100.0 * (study.fuller - 1.0):.1f} % fuller'
    own = {f'{name}, own hull': each for name, each in study.own.items()}
    shared = {f'{name}, {more}': each for name, each in study.shared.items()}
    out = f'{CENTIMETRES * study.ahead:g} cm out of place'
    askew = {f'{name}, {out}': each for name, each in study.misplaced.items()}
    return [placed(own | shared), flown(own | shared | askew), lighted(study)]


def placed(entries: dict[str, Tried]) -> Table:
    """Return what follows from where the panels sit."""
    heads = ('mount', 'mass [g]', 'ballast [g]', 'CG below CB [cm]', 'inertia, pitch [g m²]',
             'drag, ahead [mN s²/m²]', 'righting [mN m/°]', 'period by hand [s]', 'simulated [s]',
             'damping by hand [%]', 'simulated [%]')  # fmt: skip
    rows = []
    for name, each in entries.items():
        body, swing, free = each.fitted.vehicle, each.swing, each.release
        rows.append([
            name,
            number(body.mass, 1, GRAMS),
            number(body.ballast, 1, GRAMS),
            number(-float(body.cg[2]), 1, CENTIMETRES),
            number(float(body.inertia[1, 1]), 1, GRAMS),
            number(body.effects()['quadratic_drag']['surge'], 1, 1e3),
            number(swing.stiffness, 2, 1e3 / DEGREES),
            number(swing.period, 3),
            number(free.period, 3),
            number(swing.ratio, 3, 100.0),
            number(free.damping, 3, 100.0),
        ])  # fmt: skip
    return Table('What follows from the place', heads, rows)


def flown(entries: dict[str, Tried]) -> Table:
    """Return the flights."""
    heads = ('mount', 'lean at rest [°]', 'swing after lift-off [±°]', 'pitch on the way [±°]',
             'its rms [°]', 'hovering [mW]', 'flying [mW]',
             'out of place for ±2.5° [cm]')  # fmt: skip
    rows = []
    for name, each in entries.items():
        told = [
            within(each, key, digits, factor)
            for key, digits, factor in (
                ('swing', 2, DEGREES), ('amplitude', 2, DEGREES), ('rms', 3, DEGREES),
                ('hover', 0, 1e3), ('power', 0, 1e3),
            )
        ]  # fmt: skip
        far = number(each.misplacement, 1, CENTIMETRES) if each.fitted.ahead == 0.0 else MISSING
        rows.append([name, number(each.fitted.lean, 2, DEGREES), *told, far])
    return Table('Straight on at 0.1 m/s', heads, rows)


def within(each: Tried, key: str, digits: int, factor: float) -> str:
    """Return a figure of some flights, with how far single seeds are off where that shows."""
    found = over(each.flights, key)
    off = number(found.off, digits, factor)
    text = number(found.mean, digits, factor)
    return text if not float(off) else f'{text}\N{PLUS-MINUS SIGN}{off}'


def lighted(study: Study) -> Table:
    """Return the light on the panels."""
    heads = ['mount', *(f'{light.name} [%]' for light in LIGHTS)]
    rows = []
    for name, found in study.light.items():
        for words, key in (('in series', 'series'), ('each alone', 'apart')):
            cells = [number(getattr(each, key), 0, 100.0) for each in found.values()]
            rows.append([f'{name}, {words}', *cells])
    return Table('Light on the panels', heads, rows)


def plain(study: Study) -> dict[str, Any]:
    """Return the comparison as JSON has it: SI units, angles in rad."""
    return {
        'vehicle': study.vehicle, 'misplacement': study.ahead, 'fuller': study.fuller,
        'lift_lacking': dict(study.lacking),
        **{
            group: {name: _plain(each) for name, each in getattr(study, group).items()}
            for group in ('own', 'shared', 'misplaced')
        },
        'overturning': [
            {'cg_height': each.height, 'turned_over_after': each.release.turned,
             'greatest_tilt': float(abs(each.release.tilt).max()), 'growth_by_hand': each.growth}
            for each in study.overturning
        ],
        'light': {
            name: {light: {'series': at.series, 'apart': at.apart} for light, at in found.items()}
            for name, found in study.light.items()
        },
    }  # fmt: skip


def _plain(each: Tried) -> dict[str, Any]:
    body = each.fitted.vehicle
    keys = ('swing', 'lean', 'amplitude', 'rms', 'hover', 'power')
    return {
        'mass': body.mass, 'ballast': body.ballast, 'cg': body.cg.tolist(),
        'inertia': body.inertia.tolist(), 'lean_by_hand': each.fitted.lean,
        'stiffness': each.swing.stiffness, 'period_by_hand': each.swing.period,
        'period': each.release.period, 'damping_by_hand': each.swing.ratio,
        'damping': each.release.damping, 'misplacement_for_paper': each.misplacement,
        **{key: over(each.flights, key).mean for key in keys},
    }  # fmt: skip
