# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Collect the wind-tunnel results of GT-MAB: drag fits, rotors on, and its matrix B."""

from collections.abc import Mapping, Sequence
from functools import partial
import math
from typing import Final

from lta_config.command_line import format_lta_command
from lta_config.constants import AIR_DENSITY
from lta_config.files import share_folder
from lta_config.schema.comparison_file import load_comparison
from lta_flight.flight_spec import build_vehicle_scenario_stack, load_spec
from lta_model.electrical.loads import BENCH
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.charts import ChartAxis, Curve, draw_curves
from lta_report.drawing import create_figure
from lta_report.palette import ESTIMATE, LAMP, PAPER, TRUTH
from lta_studies.cfd.report import draw_drag
from lta_studies.platforms.flight import build_entrant, compute_lift_margin
from lta_studies.reproduce.studies import pressure
from lta_studies.reproduce.study_result import (
    collect_draws,
    MeasuredValue,
    RowStudyRequest,
    RowStudyResult,
    StudyPicture,
)
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
    """Return the drag coefficients, and the net force of both upward rotors [SI]."""
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
        names += [f'{title}<br>{name.replace("_", " ")}' for name in vehicle.rotor_names]
        rows += vehicle.allocation
    # Shape (rotors, 6): the transpose of B as the paper writes it, as names need a row each
    values = np.array(rows)
    # Cells that round to zero stay empty.
    written = [[f'{each:.2f}' if round(abs(each), 2) else '' for each in row] for row in values]
    figure = create_figure()
    figure.add_trace(
        Heatmap(
            x=[each.replace(' ', '<br>') for each in WRENCH_LABELS], y=names,
            z=values.tolist(), zmin=-1.0, zmax=1.0, showscale=False,
            colorscale=[[0.0, ESTIMATE], [0.5, PAPER], [1.0, TRUTH]], xgap=2, ygap=2,
            text=written, texttemplate='%{text}', textfont={'size': 10},
            hovertemplate='%{y}: %{x} %{z:.3f}<extra></extra>',
        )
    )  # fmt: skip
    figure.update_xaxes(tickangle=0, showgrid=False)
    figure.update_yaxes(autorange='reversed', automargin=True, showgrid=False)
    return figure.update_layout(margin={'r': 8})  # room for numbers in the cells on a phone


LINEAR_TERM_SPEED: Final = 0.2  # m/s, seed paper: the speed of the linear terms
NOT_IN_TABLE: Final = 'solar_panels'  # missing in the paper's table of masses
THRUST_CAPTION: Final = (
    "Thrust against duty: the paper's polynomial, and Bitcraze's bench data, whose voltage "
    'drops with load. Both were measured with four motors and divided by four.'
)


def run_study(request: RowStudyRequest) -> RowStudyResult:
    """Collect forces and masses of the vehicle files."""
    vehicle, beavis, sweep = load_vehicle('gtmab'), load_beavis_variants(), load_sweep()
    values = {
        **measure_thrust(vehicle), **net_forces(vehicle, beavis), **mass_budget(vehicle),
        **drag_coefficients(vehicle), **collect_coefficients(sweep),
    }  # fmt: skip
    linear, quadratic = (
        float(values[name].value) for name in ('tunnel_surge_linear', 'tunnel_surge')
    )
    values['slow_linear_tunnel'] = MeasuredValue(linear_share(linear, quadratic))
    # Thrust per disk area [Pa]
    loading = vehicle.full_thrust / (math.pi * (pressure.PROPELLER / 2.0) ** 2)
    values |= {
        'disk_loading': MeasuredValue(loading),
        **pressure.measure_pressures(vehicle),
    }
    command = format_lta_command('vehicle', 'show', 'gtmab')
    curve = StudyPicture(
        'thrust', 'Thrust of one rotor', THRUST_CAPTION, plot_thrust(vehicle), command
    )
    both = {'GT-MAB': vehicle, 'BEAVIS': beavis['beavis']}
    return RowStudyResult(
        values,
        [
            curve,
            *plot_drag_and_matrices(sweep, both),
            *pressure.plot_pressures_and_maps(values),
        ],
        draws=collect_draws(request, partial(measure_draw, request)),
    )


def measure_draw(request: RowStudyRequest, seed: int) -> dict[str, float | str]:
    """Return the measures of GT-MAB and BEAVIS drawn from their ranges."""
    vehicle = draw_vehicle(request, seed, 'gtmab')
    values = net_forces(vehicle, {'beavis': draw_vehicle(request, seed, 'beavis')})
    values |= mass_budget(vehicle) | drag_coefficients(vehicle)
    return {name: each.value for name, each in values.items()}


def draw_vehicle(request: RowStudyRequest, seed: int, name: str) -> Vehicle:
    """Return a vehicle drawn from its ranges."""
    spec = load_spec(name, 'hall', 'bag', '').with_values(request.draw_changes(seed, name))
    return build_vehicle_scenario_stack(spec)[0]


def linear_share(linear: float, quadratic: float) -> float:
    """Return the linear share of drag at the least speed of the paper's tunnel [1]."""
    total = linear + quadratic * LINEAR_TERM_SPEED
    return linear / total if total else math.nan


def load_beavis_variants() -> dict[str, Vehicle]:
    """Return BEAVIS as simulated in our wind tunnel, and as in the paper's figure."""
    contestants = load_comparison('platforms').contestants
    return {
        name: build_entrant(contestants[name], AIR_DENSITY).vehicle
        for name in ('beavis', 'beavis_paper')
    }


def measure_thrust(vehicle: Vehicle) -> dict[str, MeasuredValue]:
    """Return the full thrust of a rotor, and the rms deviation of the bench data."""
    a, b = vehicle.thrust_curve
    # Thrust curve a d^2 + b d by duty d
    off = [row.thrust - (a * row.duty + b) * row.duty for row in BENCH]
    return {
        'full_thrust': MeasuredValue(vehicle.full_thrust),
        'bench_off': MeasuredValue(math.sqrt(sum(each * each for each in off) / len(off))),
    }


def net_forces(vehicle: Vehicle, beavis: Mapping[str, Vehicle]) -> dict[str, MeasuredValue]:
    """Return net vertical and horizontal forces at full command, including jets on the hull."""
    # Shape (rotors, 6): force and moment of each rotor at full thrust
    columns = np.array([rotor.column for rotor in vehicle.rotors]) * vehicle.full_thrust
    up, ahead = columns[columns[:, 2] > 0.0], columns[columns[:, 0] > 0.0]
    return {
        'gtmab_up': MeasuredValue(float(up[:, 2].sum())),
        'gtmab_ideal_all': MeasuredValue(4.0 * vehicle.full_thrust),
        'gtmab_ahead': MeasuredValue(float(ahead[:, 0].sum())),
        **{
            f'{name}_up': MeasuredValue(compute_lift_margin(each)[0])
            for name, each in beavis.items()
        },
    }


def mass_budget(vehicle: Vehicle) -> dict[str, MeasuredValue]:
    """Return the mass and lift budget [kg]."""
    parts = vehicle.file.parts
    panels = sum(part.mass.si for name, part in parts.items() if NOT_IN_TABLE in name)
    total = sum(part.mass.si for part in parts.values())
    return {
        'table': MeasuredValue(total - panels),
        'with_panels': MeasuredValue(total),
        'lift': MeasuredValue(vehicle.gross_lift),
        'left': MeasuredValue(vehicle.ballast_mass),
    }


def drag_coefficients(vehicle: Vehicle) -> dict[str, MeasuredValue]:
    """Return the drag coefficients of the vehicle file."""
    effects = vehicle.collect_effects()
    quadratic, turning = effects['quadratic_drag'], effects['rotational_drag']
    return {
        'drag_ahead': MeasuredValue(quadratic['surge']),
        'drag_up': MeasuredValue(quadratic['heave']),
        'slow_linear': MeasuredValue(
            linear_share(effects['linear_drag']['surge'], quadratic['surge'])
        ),
        'linear_ahead': MeasuredValue(effects['linear_drag']['surge']),
        'linear_yaw': MeasuredValue(turning['yaw']),
        'drag_yaw': MeasuredValue(turning['yaw_2']),
    }


def plot_thrust(vehicle: Vehicle) -> Figure:
    """Plot the paper's thrust curve and the bench data."""
    a, b = vehicle.thrust_curve
    duty = np.linspace(0.0, 1.0, 101)
    curves = [
        Curve('paper', duty, (a * duty + b) * duty, TRUTH, '%{y:.3f} N'),
        Curve('bench', [row.duty for row in BENCH], [row.thrust for row in BENCH], LAMP,
              '%{y:.3f} N', 'markers', size=6),
    ]  # fmt: skip
    return draw_curves(curves, ChartAxis('duty'), ChartAxis('thrust [N]'))
