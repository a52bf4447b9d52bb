# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta light calibrate` takes: a turn in front of a lamp."""

from collections.abc import Mapping
import math
from pathlib import Path
from typing import Final, final

from lta_config.errors import BadInput
from lta_report.charts import ChartAxis, Curve, draw_curves, draw_polar
from lta_report.formatting import Tile
from lta_report.palette import ESTIMATE, SETPOINT, TIME, TRUTH
from lta_report.report import Grid, Picture, Report, TextSection, TextTable
from lta_report.request import argument, option, ReportRequest, ROBOT, StudyRun, VEHICLE
from lta_studies.light.bearing.bench import median_error
from lta_studies.light.turn.readings import (
    align_directions,
    DirectionErrors,
    fit_response,
    FittedResponse,
    read_turn,
    summarize_directions,
    TurnMotion,
    TurnReadings,
)
from lta_vlc.diodes import DiodeArray
from lta_vlc.settings import DemodulationSettings
import numpy as np
from plotly.graph_objects import Figure


@final
class DiodeCalibrationRequest(ReportRequest, command='light calibrate'):
    """
    Measure response, gains and bearing errors of the photodiodes by a turn in front of a lamp.

    Turn the drone by 360 degrees or more, 3 m from the lamp, in 20 s or more: in hover, by hand,
    or level on a turntable, whose motion is --rate, or --step with --hold (22.5 degrees give the
    paper's 16 directions). Prints the entries for the vehicle file. The demodulator then knows the
    photodiodes, and its bearings are more accurate. The page has the median bearing error in each
    direction, by the paper's weighted mean and by our fit.

    Exit status 0: done. 2: bad input.

    Example: lta light calibrate runs/turn

    Example: lta light calibrate bench_bag --step 22.5 --hold 6
    """

    bag: Path = argument('Bag of a turn in front of the lamp.')
    vehicle: str = VEHICLE
    frequency: float = option(
        'Flicker frequency of the lamp in Hz.', default=DemodulationSettings().frequency, low=1.0,
        high=1e5,
    )  # fmt: skip
    topic: str = option('Odometry topic with the heading.', default='odom')
    rate: float = option(
        'Constant speed of a turntable in deg/s, counter-clockwise, instead of --topic.',
        default=0.0,
    )
    step: float = option(
        'Step of a turntable in degrees, instead of --topic; needs --hold.', default=0.0
    )
    hold: float = option(
        'Time at each step of the turntable in seconds; needs --step.', default=0.0, low=0.0,
        high=3600.0,
    )  # fmt: skip
    distance: float = option(
        'Distance from the photodiodes to the lamp in metres.', default=3.0, low=0.3
    )
    robot: str | None = ROBOT

    def run(self, run: StudyRun) -> Report:
        """Return the report of the turn."""
        # Step and hold belong together and exclude a constant rate
        if bool(self.step) != bool(self.hold) or (self.rate and self.step):
            raise BadInput(
                'The motion of the turntable is ambiguous or incomplete; give either --rate, or '
                'both --step and --hold.'
            )
        motion = TurnMotion(
            self.topic, math.radians(self.rate), math.radians(self.step), self.hold
        )
        readings, diodes = read_turn(
            self.bag, self.robot, self.vehicle, self.frequency, motion, run.console
        )
        readings = align_directions(readings)
        response = fit_response(readings, diodes, self.distance)
        errors = summarize_directions(readings)
        return build_report(
            errors, readings, response, diodes, {'bag': str(self.bag), 'vehicle': self.vehicle}
        )


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
        Tile('fit', f'{math.degrees(median_error(errors.ours)):.2f}', '°',
             f'worst {math.degrees(max(errors.ours)):.2f}°'),
        Tile('paper', f'{math.degrees(median_error(errors.paper)):.2f}', '°',
             f'worst {math.degrees(max(errors.paper)):.2f}°'),
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
