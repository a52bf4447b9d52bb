"""Build the report of a turn, from which response and gains are calibrated."""

from collections.abc import Mapping
import math
from typing import Final

from lta_report.charts import ChartAxis, Curve, draw_curves, draw_polar
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, SETPOINT, TIME, TRUTH
from lta_report.report import Grid, Picture, Report, TextSection, TextTable
from lta_studies.light.bearing.study import median_error
from lta_studies.light.turn.readings import DirectionErrors, FittedResponse, TurnReadings
from lta_vlc.diodes import DiodeArray
import numpy as np
from plotly.graph_objects import Figure

POLAR: Final = (
    'Direction: true direction of the lamp, counter-clockwise from the nose. Radius: median '
    'bearing error there. Blue: our fit. Orange: the weighted mean of the paper (Huang et '
    'al. 2025).'
)
DIODE_CAPTION: Final = (
    'Each dot is the reading of one diode in one direction, divided by its gain and the '
    'strength of the lamp. The line is the fitted response; its exponent goes into the '
    'vehicle file.'
)
TURN_METHOD: Final = (
    'A light board turns in front of a lamp. The direction of the lamp is the heading by the '
    'odometry, or the angle of the turntable, plus a constant that is the median of the fit: an '
    'error that is the same in all directions is not seen. Each reading is one block of ADC '
    'samples (100 ms). Exponent, gains and diffuse light are fitted over all directions. Their '
    'deviations are jackknife estimates over 16 directions. The gains are relative to their mean; '
    'what remains unknown of each is its deviation, which becomes the new gain_spread.'
)
RESPONSE_POINTS: Final = 91  # of the fitted curve, every 2 degrees


def build_report(
    errors: DirectionErrors,
    readings: TurnReadings,
    response: FittedResponse,
    diodes: DiodeArray,
    facts: Mapping[str, str],
) -> Report:
    """Return the report of a turn; `facts` is the origin of the recording."""
    source = f'measured: turn of {facts["bag"]}'
    entries = format_entries(response, source)
    lines = [f'    {name}: {value}' for name, value in entries.items()]
    count = readings.amplitude.shape[1]
    return Report(
        command='light calibrate',
        subject=facts['vehicle'],
        headline=f'The response of the photodiodes is cos^{response.exponent:.2f} '
        f'(\N{PLUS-MINUS SIGN} {response.exponent_deviation:.1g}), and their gains differ by '
        f'{1e2 * response.gain_spread:.1f} % (each \N{PLUS-MINUS SIGN} '
        f'{1e2 * response.gain_uncertainty:.1g} %).',
        introduction=f'{count} diodes, {len(readings.direction)} blocks of ADC samples.',
        tiles=build_tiles(errors, response),
        blocks=(
            Grid((
                Picture('polar', 'Error by direction', POLAR, draw_polar({
                    'paper': (errors.paper, ESTIMATE), 'fit': (errors.ours, TRUTH),
                })),
                Picture(
                    'curve', 'Angular response of a diode', DIODE_CAPTION,
                    plot_response(readings, response, diodes),
                ),
            )),
            build_gain_table(response),
            TextTable(
                'Entries for the vehicle file, below sensors.diodes', ('entry', 'value'),
                [list(each) for each in entries.items()],
            ),
            TextSection('Method', (TURN_METHOD,)),
        ),
        data={
            'diodes': count, 'snr': errors.snr, 'paper': errors.paper, 'fit': errors.ours,
            'blocks': errors.blocks, 'response': response._asdict(), 'entries': entries,
        },
        facts=facts,
        # Lines to paste into the vehicle file
        closing=('Put these lines below sensors.diodes in the vehicle file:', *lines),
    )  # fmt: skip


def format_entries(response: FittedResponse, source: str) -> dict[str, str]:
    """Return the measured entries of `sensors.diodes` as YAML, by name."""
    gains = ', '.join(f'{gain:.4f}' for gain in response.gains)
    values = {
        'response': f'{response.exponent:.3f}, unit: "1"',
        'response_deviation': f'{response.exponent_deviation:.3f}, unit: "1"',
        'gains': f'[{gains}]',
        'gain_spread': f'{1e2 * response.gain_uncertainty:.2f}, unit: "%"',
    }
    return {name: f'{{value: {text}, source: "{source}"}}' for name, text in values.items()}


def build_gain_table(response: FittedResponse) -> TextTable:
    """Return the table of diode gains."""
    rows = [
        [str(k), f'{gain:.3f}', f'{deviation:.3f}']
        for k, (gain, deviation) in enumerate(
            zip(response.gains, response.gain_deviations, strict=True), start=1
        )
    ]
    return TextTable('Gains', ('diode', 'gain', 'standard deviation'), rows)


def build_tiles(errors: DirectionErrors, response: FittedResponse) -> list[Tile]:
    """Return the tiles with the key figures."""
    return [
        Tile('fit', f'{math.degrees(median_error(errors.ours)):.2f}', '°', f'worst '
        f'{math.degrees(max(errors.ours)):.2f}°'),
        Tile('paper', f'{math.degrees(median_error(errors.paper)):.2f}', '°', f'worst '
        f'{math.degrees(max(errors.paper)):.2f}°'),
        Tile('SNR', f'{errors.snr:.0f}', '', 'of the best diode, median'),
        Tile('exponent', f'{response.exponent:.2f}', '',
             f'of the cosine response, \N{PLUS-MINUS SIGN} {response.exponent_deviation:.1g}'),
        Tile('gains', f'{1e2 * response.gain_spread:.1f}', '%', 'spread among the diodes'),
        Tile('pedestal', f'{1e2 * response.pedestal:.1f}', '%',
             'of the largest signal, from reflections'),
    ]  # fmt: skip


def plot_response(readings: TurnReadings, response: FittedResponse, diodes: DiodeArray) -> Figure:
    """Plot the reading of each diode against the angle between its axis and the lamp."""
    axes = np.array(diodes.axes)
    azimuth = np.arctan2(axes[:, 1], axes[:, 0])
    # Angle to the lamp, wrapped to [-180, 180) degrees first
    apart = np.degrees(np.abs(
        (readings.direction[:, None] - azimuth + math.pi) % math.tau - math.pi
    ))  # fmt: skip
    # Normalised: a diode that faces the lamp reads 1 plus the pedestal.
    read = readings.amplitude / (np.array(response.gains) * response.strength)
    curves = [
        Curve(f'diode {k + 1}', apart[:, k], read[:, k], TIME[k % len(TIME)], '%{y:.3f}',
              'markers', size=4)
        for k in range(len(azimuth))
    ]  # fmt: skip
    angle = np.linspace(0.0, 180.0, RESPONSE_POINTS)
    cosine = np.maximum(np.cos(np.radians(angle)), 0.0)
    fit = cosine**response.exponent + response.pedestal
    curves.append(Curve('fit', angle, fit, SETPOINT, '%{y:.3f}', width=1.4))
    figure = draw_curves(
        curves,
        ChartAxis("angle between the diode's axis and the lamp [°]", more={'dtick': 30}),
        ChartAxis('reading, relative to a diode that faces the lamp', zero=True),
    )
    return figure.update_layout(hovermode='closest', showlegend=False)
