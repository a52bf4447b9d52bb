# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compare hull pressures in flight (potential flow) and under jets (CFD) with the paper's."""

from collections.abc import Mapping
import textwrap
from typing import Final

from lta_config.command_line import format_lta_command
from lta_config.constants import AIR_DENSITY
from lta_config.files import share_folder
from lta_model.vehicle import Vehicle
from lta_report.drawing import create_figure
from lta_report.palette import ESTIMATE, LAMP, TRUTH, WALL
from lta_report.palette import PAPER as WHITE
from lta_sim.wind_limits import static_wind_limit
from lta_studies.reproduce.study_result import MeasuredValue, StudyPicture
from lta_windtunnel.analytic import pressure_extremes
from lta_windtunnel.sweep_table import Blow, read_sweep, SurfacePressure
import numpy as np
from plotly.graph_objects import Bar, Figure, Heatmap

PAPER_PRESSURES: Final = {'BEAVIS': 102.0, 'GT-MAB': 571.9}  # Pa, seed paper, LaTeX comment
PROPELLER: Final = 0.047  # m, seed paper
SURGE: Final = 0
PRESSURE_FLOWS: Final = {  # shipped flows: file, pattern, heading
    'gtmab': ('gtmab', 'both_up', 'GT-MAB, both upward rotors at full thrust'),
    'reversed': ('gtmab', 'up_left_reversed', 'GT-MAB, one upward rotor reversed, onto the hull'),
    'beavis': ('beavis', 'all', 'BEAVIS, all four rotors at full thrust'),
}
PRESSURE_CAPTION: Final = (
    'Logarithmic scale. Orange: printed in the paper. Other bars: computed here; the hull '
    'in flight by potential flow, a jet onto a wall by momentum theory, the rest by our '
    'simulated wind tunnel.'
)
MAP_CAPTION: Final = (
    'The hull from below, nose to the right: pressure relative to the undisturbed air, in a '
    'steady flow of our simulated wind tunnel (fidelity preview).'
)


def load_flow(name: str) -> Blow:
    """Load a shipped flow, as written by `lta cfd run`."""
    file, pattern, _ = PRESSURE_FLOWS[name]
    return read_sweep(share_folder() / 'aero' / f'{file}.blown.json').blows[pattern]


def measure_pressures(vehicle: Vehicle) -> dict[str, MeasuredValue]:
    """Return pressures in flight and under jets."""
    low, high = pressure_extremes(
        vehicle.file.hull, SURGE, static_wind_limit(vehicle), AIR_DENSITY
    )
    values = {
        'flight_nose': MeasuredValue(high),
        'flight_side': MeasuredValue(low),
    }
    for name in PRESSURE_FLOWS:
        bodies = load_flow(name).pressed
        values[f'{name}_most'] = MeasuredValue(max(each.most for each in bodies.values()))
        values[f'{name}_least'] = MeasuredValue(min(each.least for each in bodies.values()))
        values[f'{name}_hull_least'] = MeasuredValue(bodies['envelope'].least)
        values[f'{name}_hull_most'] = MeasuredValue(bodies['envelope'].most)
    values['beavis_blown_up'] = MeasuredValue(load_flow('beavis').force[2])
    return values


def plot_pressures_and_maps(values: Mapping[str, MeasuredValue]) -> list[StudyPicture]:
    """Plot all pressures, and pressure maps of the hulls from below."""
    pictures = [
        StudyPicture('pressure', 'Pressures compared', PRESSURE_CAPTION, plot_pressures(values),
                     format_lta_command('reproduce', 'forces'))
    ]  # fmt: skip
    for name, (file, pattern, heading) in PRESSURE_FLOWS.items():
        again = format_lta_command('cfd', 'run', file, '--only', pattern)
        hull = load_flow(name).pressed['envelope']
        pictures.append(
            StudyPicture(f'map_{name}', heading, MAP_CAPTION, plot_underside(hull), again)
        )
    return pictures


def plot_pressures(values: Mapping[str, MeasuredValue]) -> Figure:
    """Plot the pressures as bars on a logarithmic scale."""

    def size(name: str) -> float:
        value = values[name].value
        assert not isinstance(value, str)
        # Suction is negative, and the axis is logarithmic.
        return abs(value)

    rows = [
        ('GT-MAB: suction on its hull, both rotors up', size('gtmab_hull_least'), TRUTH),
        ('GT-MAB: nose at its top level speed', size('flight_nose'), TRUTH),
        ('GT-MAB: suction at the bar next to its rotors', size('gtmab_least'), TRUTH),
        ('GT-MAB: jet of a reversed rotor on its hull', size('reversed_most'), TRUTH),
        ('BEAVIS: jets on its hull, all rotors on', size('beavis_hull_most'), TRUTH),
        ('BEAVIS: jets on the box below', size('beavis_most'), TRUTH),
        ('Ideal jet onto a wall', size('disk_loading'), LAMP),
        ('Paper: BEAVIS', PAPER_PRESSURES['BEAVIS'], ESTIMATE),
        ('Paper: GT-MAB', PAPER_PRESSURES['GT-MAB'], ESTIMATE),
    ]
    titles, sizes, colours = zip(*rows, strict=True)
    names = [wrap_label(title) for title in titles]
    figure = create_figure()
    figure.add_trace(
        Bar(x=sizes, y=names, orientation='h', marker={'color': colours},
            text=[f'{each:.3g} Pa' for each in sizes], textposition='outside',
            cliponaxis=False, hovertemplate='%{x:.3g} Pa<extra></extra>')
    )  # fmt: skip
    figure.update_xaxes(
        type='log', title_text='pressure [Pa]', dtick=1, tickangle=0, range=[-1.2, 3.2]
    )
    figure.update_yaxes(autorange='reversed', automargin=True, showgrid=False, ticksuffix=' ')
    return figure.update_layout(hovermode='closest', margin={'r': 40})


def wrap_label(text: str) -> str:
    """Return a label in short lines, so that a phone shows it beside its bar."""
    return '<br>'.join(textwrap.wrap(text, 20))


def plot_underside(hull: SurfacePressure) -> Figure:
    """Plot the pressure on a hull as seen from below."""
    # A symmetric scale, so that zero pressure is white
    largest = max(abs(hull.least), abs(hull.most))
    # Centres of the pixels of a square around the hull centre [m]
    places = hull.side * ((np.arange(len(hull.below)) + 0.5) / len(hull.below) - 0.5)
    figure = create_figure()
    figure.add_trace(
        Heatmap(
            x=places, y=places, z=hull.below, zmin=-largest, zmax=largest, hoverongaps=False,
            colorscale=[[0.0, ESTIMATE], [0.5, WHITE], [1.0, TRUTH]],
            colorbar={'title': {'text': 'Pa'}, 'thickness': 12},
            hovertemplate='%{x:.2f}, %{y:.2f} m: %{z:.3g} Pa<extra></extra>',
        )
    )  # fmt: skip
    bare = {'showgrid': False, 'constrain': 'domain'}
    figure.update_xaxes(title_text='x [m]', **bare)
    figure.update_yaxes(
        title_text='y [m], left positive', scaleanchor='x', autorange='reversed', **bare
    )
    return figure.update_layout(plot_bgcolor=WALL, hovermode='closest')
