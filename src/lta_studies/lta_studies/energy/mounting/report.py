# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the tables and figures of the mount comparison: balance, flights and light."""

from collections.abc import Callable
import math
from typing import Any, Final

from lta_config.schema.spectrum_file import luminous_efficacy
from lta_energy.harvest import WHITE_LED
from lta_model.electrical.mppt_charger import charger_output
from lta_model.electrical.panel import array_spectral_factor, find_max_power_point
from lta_model.vehicle import Vehicle
from lta_report.charts import ChartAxis, Curve, DASHED, draw_curves
from lta_report.curves import Array
from lta_report.drawing import (
    add_legend,
    build_line_trace,
    create_figure,
    decimate_line,
    EndLabel,
    label_ends,
    padded_range,
)
from lta_report.formatting import format_number
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, TRUTH, WALL
from lta_report.report import TextTable
from lta_report.result_table import build_table, Column
from lta_studies.energy.mounting.mounted_vehicle import LIGHT_DIRECTIONS
from lta_studies.energy.mounting.run import MountingStudy, MountTrial
from lta_studies.energy.mounting.straight_flight import (
    average_over_seeds,
    FLIGHT_END,
    LIFT_OFF_TIME,
    MOUNTING_DEPARTURE,
    RELEASE_TIME,
)
from lta_vehicle.figures.mass_budget import DEGREES
import numpy as np
from plotly.graph_objects import Bar, Figure

CENTIMETRES: Final = 1e2
LAMP_LUX: Final = 80e3  # lx, seed paper
MOUNT_COLUMN: Final[Column[tuple[str, MountTrial]]] = Column('', 'mount', of=lambda row: row[0])


def trial_column(
    head: str,
    unit: str,
    digits: int,
    of: Callable[[MountTrial], Any],
    factor: float | None = None,
) -> Column[tuple[str, MountTrial]]:
    """Return a column of the named trials."""
    return Column('', head, unit, digits, lambda row: of(row[1]), factor)


def flight_column(key: str, head: str, unit: str, digits: int) -> Column[tuple[str, MountTrial]]:
    """Return a column of the mean over the flights, and how far a single one is from it."""
    return trial_column(head, unit, digits, lambda trial: average_over_seeds(trial.flights, key))


BALANCE_COLUMNS: Final = (
    MOUNT_COLUMN,
    trial_column('mass', 'g', 1, lambda trial: trial.fitted.vehicle.mass),
    trial_column('ballast', 'g', 1, lambda trial: trial.fitted.vehicle.ballast_mass),
    trial_column('CG below CB', 'cm', 1, lambda trial: -float(trial.fitted.vehicle.cg[2])),
    trial_column('inertia, pitch', 'g m²', 1,
                 lambda trial: float(trial.fitted.vehicle.inertia[1, 1]), 1e3),
    trial_column('drag, ahead', 'mN s²/m²', 1,
                 lambda trial: trial.fitted.vehicle.collect_effects()['quadratic_drag']['surge'],
                 1e3),
    # From N m/rad
    trial_column('righting', 'mN m/°', 2, lambda trial: trial.swing.stiffness,
                 1e3 / DEGREES),
    trial_column('period by hand', 's', 3, lambda trial: trial.swing.period),
    trial_column('simulated', 's', 3, lambda trial: trial.release.period),
    trial_column('damping by hand', '%', 3,
                 lambda trial: trial.swing.damping_ratio),
    trial_column('simulated', '%', 3, lambda trial: trial.release.damping_ratio),
)  # fmt: skip
FLIGHT_COLUMNS: Final = (
    MOUNT_COLUMN,
    trial_column('lean at rest', '°', 2,
                 lambda trial: trial.fitted.nose_down_pitch),
    flight_column('swing', 'swing after lift-off', '±°', 2),
    flight_column('amplitude', 'pitch in flight', '±°', 2),
    flight_column('rms', 'rms pitch', '°', 3),
    flight_column('hover', 'hovering', 'mW', 0),
    flight_column('power', 'flying', 'mW', 0),
    # Only with the panels in place is the misplacement relative to the file's position
    trial_column('misplacement for ±2.5°', 'cm', 1,
                 lambda trial: trial.misplacement if trial.fitted.ahead == 0.0 else None),
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
    """Return the charger output with a share of the light on the darkest panel [W]."""
    efficacy = luminous_efficacy(WHITE_LED)
    irradiance = LAMP_LUX / efficacy * array_spectral_factor(vehicle.file.energy, efficacy)
    voltage, current = find_max_power_point(vehicle.panel, irradiance * share)
    return charger_output(vehicle.charger, voltage * current)


ANGLE_HOVER: Final = '%{y:.3~f} °'
MOUNT_COLOURS: Final = (ESTIMATE, TRUTH, GOOD, LAMP, SETPOINT)
STRAIGHT_CAPTION: Final = (
    'Pitch (nose up positive) in closed-loop flights with seed 1, all in a hull that '
    'carries every mount. Top: panels in place. Bottom: panels misplaced forward. Dotted: '
    'release by hand, lift-off, and start of the flight at 0.1 m/s.'
)
SWING_CAPTION: Final = (
    'Pitch after a release at 5° in still air with motors off. Dashed: envelope of the '
    'linearised analytical model.'
)
OVERTURNING_CAPTION: Final = (
    'Tilt of the top mount after a release at 5°, with its centre of gravity below, at and '
    'above the centre of buoyancy and all else equal. If both centres coincide, there is no '
    'righting moment.'
)
LIGHT_CAPTION: Final = (
    'Light on the panels, relative to an unshaded plate that faces the light; for the '
    'overcast sky, to a level plate. Full: both panels in series, limited by the darker '
    'one. Pale: each panel separately.'
)


def draw_straight_flights(study: MountingStudy) -> Figure:
    """Plot pitch over time, with panels in place and misplaced."""
    figure = create_figure(2, (0.5, 0.5))
    for row, group in enumerate((study.shared, study.misplaced), start=1):
        ends, labels = [], []
        for colour, (name, each) in zip(MOUNT_COLOURS, group.items(), strict=False):
            record = each.flights[0].track.crop(LIFT_OFF_TIME - 4.0, FLIGHT_END)
            degrees = DEGREES * record.pitch
            figure.add_trace(
                build_line_trace(name, record.time, degrees, colour, unit='°', width=1.2), row, 1
            )
            # Mean over the last samples, as the last one is a random phase of the swing
            labels.append(EndLabel(name, float(degrees[-1000:].mean()), colour))
            ends.append(degrees)
        label_ends(figure, labels, padded_range(*ends), row)
        figure.update_yaxes(title_text='pitch [°]', row=row)
        for time in (RELEASE_TIME, LIFT_OFF_TIME, MOUNTING_DEPARTURE):
            figure.add_vline(
                x=time, row=row, col=1, line={'color': WALL, 'width': 1, 'dash': '2px,3px'}
            )
    return figure.update_xaxes(title_text='time [s]', row=2)


def draw_swings(study: MountingStudy) -> Figure:
    """Plot the free swing of each mount and its analytical envelope."""
    curves = []
    for colour, (name, each) in zip(MOUNT_COLOURS, study.shared.items(), strict=False):
        time = each.release.time
        lines = (name, DEGREES * each.release.tilt, 'solid'), (
            f'{name}, by hand', swing_envelope(each, time), DASHED,
        )  # fmt: skip
        curves += [
            Curve(words, *decimate_line(time, tilt), colour, ANGLE_HOVER, 'lines', dash, 1.3,
                  label=name if words == name else None)
            for words, tilt, dash in lines
        ]  # fmt: skip
    return draw_curves(curves, ChartAxis('time [s]'), ChartAxis('pitch [°]', range=(-6.0, 6.0)))


def swing_envelope(each: MountTrial, time: Array) -> Array:
    """Return the analytical envelope of the swing [deg]."""
    # Without a swing (no righting moment) the envelope is constant.
    ratio, period = each.swing.damping_ratio or 0.0, each.swing.period or math.inf
    first = DEGREES * float(each.release.tilt[0])
    # Small damping: exp(-zeta w t) with w = 2 pi / period
    return first * np.exp(-ratio * 2.0 * math.pi / period * time)


def draw_overturning(study: MountingStudy) -> Figure:
    """Plot the tilt with the centre of gravity below, at and above the hull centre."""
    curves = []
    for colour, each in zip((TRUTH, GOOD, ESTIMATE), study.overturning, strict=True):
        where = 'coincident' if each.height == 0.0 else 'above' if each.height > 0.0 else 'below'
        name = f'{where} ({100 * each.height:+.1f} cm)' if each.height else where
        line = decimate_line(each.release.time, DEGREES * each.release.tilt)
        curves.append(Curve(name, *line, colour, ANGLE_HOVER, width=1.4, label=where))
    return draw_curves(curves, ChartAxis('time [s]'), ChartAxis('tilt [°]'))


def draw_light_shares(study: MountingStudy) -> Figure:
    """Plot the shares of light as bars: in series full, separately pale behind."""
    figure = create_figure()
    names = [light.name for light in LIGHT_DIRECTIONS]
    for colour, (mount, shares) in zip(MOUNT_COLOURS, study.light.items(), strict=False):
        for key, opacity in (('apart', 0.35), ('series', 1.0)):
            figure.add_trace(
                Bar(
                    x=names, y=[100.0 * getattr(shares[name], key) for name in names],
                    name=mount, offsetgroup=mount, opacity=opacity,
                    marker={'color': colour}, showlegend=key == 'series',
                    hovertemplate='%{y:.0f} %',
                )
            )  # fmt: skip
    add_legend(figure).update_layout(barmode='group', bargap=0.3)
    # A word a line, for a narrow window
    figure.update_xaxes(tickvals=names, ticktext=[name.replace(' ', '<br>') for name in names])
    return figure.update_yaxes(title_text='share of light [%]')
