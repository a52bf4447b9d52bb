"""Collect the wind-tunnel results of GT-MAB: drag fits, rotors on, and its matrix B."""

from collections.abc import Mapping, Sequence
from typing import Final

from lta_config.command_line import format_lta_command
from lta_config.files import share_folder
from lta_model.vehicle import Vehicle
from lta_report.drawing import create_figure
from lta_report.palette import ESTIMATE, PAPER, TRUTH
from lta_studies.cfd.report import draw_drag
from lta_studies.reproduce.study_result import MeasuredValue, StudyPicture
from lta_windtunnel.aero_fit import fit_drag_by_axis
from lta_windtunnel.sweep_table import read_sweep, TunnelSweep
import numpy as np
from plotly.graph_objects import Figure, Heatmap

BOTH_UP: Final = 'both_up'  # pattern of the tunnel file: the upward rotors at full thrust
WRENCH_LABELS: Final = ('Fx', 'Fy', 'Fz', 'Mx [m]', 'My [m]', 'Mz [m]')
TUNNEL_CAPTION: Final = (
    'Points: drag from solved flows, with its variation in the averaging window. Lines: '
    'fitted linear and quadratic terms. Dotted: analytical estimate.'
)
MATRIX: Final = (
    'Matrix B of the vehicle files, one row per rotor: force and moment about the hull '
    'centre per newton of thrust, including jets on the hull.'
)


def load_sweep() -> TunnelSweep:
    """Load the raw sweep of GT-MAB, as written by `lta cfd run`."""
    return read_sweep(share_folder() / 'aero' / 'gtmab.sweep.json')


def collect_coefficients(sweep: TunnelSweep) -> dict[str, MeasuredValue]:
    """Return the drag coefficients, and the net force of both upward rotors. [SI]"""
    fits = fit_drag_by_axis(sweep)
    values = {'tunnel_up': MeasuredValue(sweep.blows[BOTH_UP].force[2])}
    for axis in ('surge', 'heave', 'roll', 'pitch', 'yaw'):
        values[f'tunnel_{axis}_linear'] = MeasuredValue(fits[axis].linear)
        values[f'tunnel_{axis}'] = MeasuredValue(fits[axis].quadratic)
    return values


def plot_drag_and_matrices(
    sweep: TunnelSweep, vehicles: Mapping[str, Vehicle]
) -> list[StudyPicture]:
    """Plot drag along and about the axes, and B of the vehicles."""
    run_command, show_command = (
        format_lta_command('cfd', 'run', 'gtmab'),
        format_lta_command('vehicle', 'show', 'gtmab'),
    )
    along, about = draw_drag(sweep, turning=False), draw_drag(sweep, turning=True)
    return [
        StudyPicture('drag', 'Drag along the axes', TUNNEL_CAPTION, along, run_command),
        StudyPicture('turning', 'Drag about the axes', TUNNEL_CAPTION, about, run_command),
        StudyPicture('matrix', 'Thrust allocation', MATRIX, plot_matrices(vehicles), show_command),
    ]


def plot_matrices(vehicles: Mapping[str, Vehicle]) -> Figure:
    """Plot B of each vehicle, a row for each rotor, with the numbers in the cells."""
    names: list[str] = []
    rows: list[Sequence[float]] = []
    for title, vehicle in vehicles.items():
        names += [f'{title} {name.replace("_", " ")}' for name in vehicle.rotor_names]
        rows += vehicle.allocation
    # Shape (rotors, 6): the transpose of B as the paper writes it, as names need a row each
    values = np.array(rows)
    # Cells that round to zero stay empty.
    written = [[f'{each:.2f}' if round(abs(each), 2) else '' for each in row] for row in values]
    figure = create_figure()
    figure.add_trace(
        Heatmap(
            x=list(WRENCH_LABELS), y=names, z=values.tolist(), zmin=-1.0, zmax=1.0,
            showscale=False,
            colorscale=[[0.0, ESTIMATE], [0.5, PAPER], [1.0, TRUTH]], xgap=2, ygap=2,
            text=written, texttemplate='%{text}',
            hovertemplate='%{y}: %{x} %{z:.3f}<extra></extra>',
        )
    )  # fmt: skip
    figure.update_xaxes(tickangle=0)
    return figure.update_yaxes(autorange='reversed', automargin=True)
