"""Build the tables and the JSON of the mount comparison: balance, flights and light."""

from collections.abc import Callable
from typing import Any, Final

from lta_config.schema.spectrum_file import luminous_efficacy
from lta_energy.harvest import WHITE_LED
from lta_model.electrical.charger import charger_output
from lta_model.electrical.panel import array_spectral_factor, find_max_power_point
from lta_model.vehicle import Vehicle
from lta_report.formatting import format_number
from lta_report.report import TextTable
from lta_report.result_table import build_table, Column, to_record
from lta_studies.energy.mounting.mounted_vehicle import LIGHT_DIRECTIONS
from lta_studies.energy.mounting.run import MountingStudy, MountTrial
from lta_studies.energy.mounting.straight_flight import average_over_seeds
from lta_vehicle.figures.mass_budget import DEGREES

CENTIMETRES: Final = 1e2
LAMP_LUX: Final = 80e3  # lx, seed paper
MOUNT_COLUMN: Final[Column[tuple[str, MountTrial]]] = Column('', 'mount', of=lambda row: row[0])


def trial_column(
    key: str,
    head: str | None = None,
    unit: str = '',
    digits: int | None = None,
    of: Callable[[MountTrial], Any] | None = None,
    factor: float | None = None,
) -> Column[tuple[str, MountTrial]]:
    """Return a column of the named trials; without `of`, of the flights' means of `key`."""
    value = of or (lambda trial: average_over_seeds(trial.flights, key).mean)
    return Column(key, head, unit, digits, lambda row: value(row[1]), factor)


def flight_column(key: str, head: str, unit: str, digits: int) -> Column[tuple[str, MountTrial]]:
    """Return a column of the mean over the flights, and how far a single one is from it."""
    return trial_column(
        '', head, unit, digits, lambda trial: average_over_seeds(trial.flights, key)
    )


BALANCE_COLUMNS: Final = (
    MOUNT_COLUMN,
    trial_column('mass', 'mass', 'g', 1, lambda trial: trial.fitted.vehicle.mass),
    trial_column('ballast', 'ballast', 'g', 1, lambda trial: trial.fitted.vehicle.ballast_mass),
    trial_column('', 'CG below CB', 'cm', 1, lambda trial: -float(trial.fitted.vehicle.cg[2])),
    trial_column('cg', of=lambda trial: trial.fitted.vehicle.cg),
    trial_column('inertia', of=lambda trial: trial.fitted.vehicle.inertia),
    trial_column('', 'inertia, pitch', 'g m²', 1,
                 lambda trial: float(trial.fitted.vehicle.inertia[1, 1]), 1e3),
    trial_column('', 'drag, ahead', 'mN s²/m²', 1,
                 lambda trial: trial.fitted.vehicle.collect_effects()['quadratic_drag']['surge'],
                 1e3),
    # From N m/rad
    trial_column('stiffness', 'righting', 'mN m/°', 2, lambda trial: trial.swing.stiffness,
                 1e3 / DEGREES),
    trial_column('period_by_hand', 'period by hand', 's', 3, lambda trial: trial.swing.period),
    trial_column('period', 'simulated', 's', 3, lambda trial: trial.release.period),
    trial_column('damping_by_hand', 'damping by hand', '%', 3,
                 lambda trial: trial.swing.damping_ratio),
    trial_column('damping', 'simulated', '%', 3, lambda trial: trial.release.damping_ratio),
)  # fmt: skip
FLIGHT_COLUMNS: Final = (
    MOUNT_COLUMN,
    trial_column('lean_by_hand', 'lean at rest', '°', 2,
                 lambda trial: trial.fitted.nose_down_pitch),
    flight_column('swing', 'swing after lift-off', '±°', 2),
    flight_column('amplitude', 'pitch in flight', '±°', 2),
    flight_column('rms', 'rms pitch', '°', 3),
    flight_column('hover', 'hovering', 'mW', 0),
    flight_column('power', 'flying', 'mW', 0),
    # Only with the panels in place is the misplacement relative to the file's position
    trial_column('', 'misplacement for ±2.5°', 'cm', 1,
                 lambda trial: trial.misplacement if trial.fitted.ahead == 0.0 else None),
    trial_column('misplacement_for_paper', of=lambda trial: trial.misplacement),
    *map(trial_column, ('swing', 'lean', 'amplitude', 'rms', 'hover', 'power')),
)  # fmt: skip


def build_comparison_tables(study: MountingStudy) -> list[TextTable]:
    """Return every table of the comparison."""
    more = f'hull {100.0 * (study.fuller - 1.0):.1f} % larger'
    own = {f'{name}, own hull': each for name, each in study.own.items()}
    shared = {f'{name}, {more}': each for name, each in study.shared.items()}
    out = f'panels {CENTIMETRES * study.ahead:g} cm too far forward'
    misplaced = {f'{name}, {out}': each for name, each in study.misplaced.items()}
    return [
        build_table('Balance and swing', BALANCE_COLUMNS, (own | shared).items()),
        build_table(
            'Straight flight at 0.1 m/s', FLIGHT_COLUMNS, (own | shared | misplaced).items()
        ),
        build_light_table(study),
    ]


def build_light_table(study: MountingStudy) -> TextTable:
    """Return the table of light on the panels."""
    heads = ['mount, light in %', *(light.name for light in LIGHT_DIRECTIONS)]
    rows = []
    for name, shares in study.light.items():
        for words, key in (('in series', 'series'), ('separately', 'apart')):
            cells = [format_number(getattr(each, key), 0, 100.0) for each in shares.values()]
            rows.append([f'{name}, {words}', *cells])
    for name, shares in study.light.items():
        vehicle = study.shared[name].fitted.vehicle
        powers = (compute_charger_output(vehicle, each.series) for each in shares.values())
        cells = [format_number(power, 0, 1e3) for power in powers]
        rows.append([f'{name}, after the charger [mW]', *cells])
    note = f'After the charger: under {1e-3 * LAMP_LUX:g} klx of white LED light.'
    return TextTable('Light on the panels', heads, rows, note)


def compute_charger_output(vehicle: Vehicle, share: float) -> float:
    """Return the charger output with a share of the light on the darkest panel. [W]"""
    efficacy = luminous_efficacy(WHITE_LED)
    irradiance = LAMP_LUX / efficacy * array_spectral_factor(vehicle.file.energy, efficacy)
    voltage, current = find_max_power_point(vehicle.panel, irradiance * share)
    return charger_output(vehicle.charger, voltage * current)


def to_json(study: MountingStudy) -> dict[str, Any]:
    """Convert the comparison to JSON, in SI units."""
    return {
        'vehicle': study.vehicle, 'misplacement': study.ahead, 'fuller': study.fuller,
        'lift_lacking': dict(study.lacking),
        **{
            group: {
                name: to_record((*BALANCE_COLUMNS, *FLIGHT_COLUMNS), (name, each))
                for name, each in getattr(study, group).items()
            }
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
