"""Forces of the vehicle files: thrust, net forces at full command, drag, and the mass budget."""

import math
from typing import Final

from lta_analysis.platforms.entries import entrant
from lta_analysis.platforms.summary import margin
from lta_analysis.report.drawing import blank
from lta_analysis.report.palette import ESTIMATE, LAMP, SOFT, TRUTH
from lta_analysis.reproduce.found import Asked, Found, Picture, Value
from lta_analysis.typed import typed
from lta_config.comparison_file import load_comparison
from lta_config.constants import AIR_DENSITY
from lta_energy.rotor import BENCH
from lta_sim.vehicle import load_vehicle, Vehicle
import numpy as np
from plotly.graph_objects import Figure, Scatter

PROPELLER: Final = 0.047  # m, seed paper
NOT_IN_TABLE: Final = 'solar_panels'  # no row of the paper's table of masses
AXES: Final = {'surge': ('ahead and aside', TRUTH), 'heave': ('up', ESTIMATE)}
CURVE: Final = (
    "One rotor: the paper's polynomial, and Bitcraze's bench, whose voltage falls on the way. "
    'Both are of four motors, divided by four.'
)
DRAG: Final = (
    'Drag of the vehicle file by speed, along and up; it comes from our own wind tunnel (see its '
    'sources), fitted from 0.2 to 2.0 m/s.'
)


def study(asked: Asked) -> Found:
    """Return what the vehicle files hold; chance has no part in it."""
    del asked
    vehicle = load_vehicle('gtmab')
    values = {**thrust(vehicle), **forces(vehicle), **masses(vehicle), **drag(vehicle)}
    command = typed('vehicle', 'show', 'gtmab')
    pictures = [
        Picture('thrust', 'Thrust of one rotor', CURVE, thrust_picture(vehicle), command),
        Picture('drag', 'Drag', DRAG, drag_picture(vehicle), command),
    ]
    return Found(values, pictures)


def thrust(vehicle: Vehicle) -> dict[str, Value]:
    """Return full thrust of a rotor, how far the bench is off, and its disk loading."""
    a, b = vehicle.thrust_curve
    off = [row.thrust - (a * row.duty + b) * row.duty for row in BENCH]
    disk = math.pi * (PROPELLER / 2.0) ** 2
    return {
        'full_thrust': Value(vehicle.full_thrust),
        'bench_off': Value(math.sqrt(sum(each * each for each in off) / len(off))),
        'disk_loading': Value(vehicle.full_thrust / disk),
    }


def forces(vehicle: Vehicle) -> dict[str, Value]:
    """Return net vertical and horizontal forces at full command, jets on the hull included."""
    comparison = load_comparison('platforms')
    beavis = {
        name: entrant(comparison.contestants[name], AIR_DENSITY).vehicle
        for name in ('beavis', 'beavis_paper')
    }
    columns = np.array([rotor.column for rotor in vehicle.rotors]) * vehicle.full_thrust
    up, ahead = columns[columns[:, 2] > 0.0], columns[columns[:, 0] > 0.0]
    return {
        'gtmab_up': Value(float(up[:, 2].sum())),
        'gtmab_ideal_all': Value(4.0 * vehicle.full_thrust),
        'gtmab_ahead': Value(float(ahead[:, 0].sum())),
        **{f'{name}_up': Value(margin(each)[0]) for name, each in beavis.items()},
    }


def masses(vehicle: Vehicle) -> dict[str, Value]:
    """Return the budget of masses and lift. [kg]"""
    parts = vehicle.file.parts
    panels = sum(part.mass.si for name, part in parts.items() if NOT_IN_TABLE in name)
    total = sum(part.mass.si for part in parts.values())
    return {
        'table': Value(total - panels),
        'with_panels': Value(total),
        'lift': Value(vehicle.lift),
        'left': Value(vehicle.ballast),
    }


def drag(vehicle: Vehicle) -> dict[str, Value]:
    """Return the coefficients of drag of the vehicle file."""
    effects = vehicle.effects()
    quadratic, turning = effects['quadratic_drag'], effects['rotational_drag']
    return {
        'drag_ahead': Value(quadratic['surge']),
        'drag_up': Value(quadratic['heave']),
        'linear_ahead': Value(effects['linear_drag']['surge']),
        'linear_yaw': Value(turning['yaw']),
        'drag_yaw': Value(turning['yaw_2']),
    }


def thrust_picture(vehicle: Vehicle) -> Figure:
    """Return the paper's curve and the bench."""
    figure = blank()
    a, b = vehicle.thrust_curve
    duty = np.linspace(0.0, 1.0, 101)
    figure.add_trace(
        Scatter(x=duty, y=(a * duty + b) * duty, mode='lines', name='paper',
                line={'color': TRUTH, 'width': 1.6}, hovertemplate='%{y:.3f} N')
    )  # fmt: skip
    figure.add_trace(
        Scatter(x=[row.duty for row in BENCH],
                y=[row.thrust for row in BENCH],
                mode='markers', name='bench', marker={'color': LAMP, 'size': 6},
                hovertemplate='bench %{y:.3f} N')
    )  # fmt: skip
    figure.update_xaxes(title_text='duty', title_font={'color': SOFT})
    figure.update_yaxes(title_text='thrust [N]')
    return figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.08})


def drag_picture(vehicle: Vehicle) -> Figure:
    """Return drag by speed along each axis."""
    figure = blank()
    speed = np.linspace(0.0, 2.0, 101)
    quadratic, linear = vehicle.effects()['quadratic_drag'], vehicle.effects()['linear_drag']
    for axis, (told, colour) in AXES.items():
        figure.add_trace(
            Scatter(x=speed, y=(linear[axis] + quadratic[axis] * speed) * speed, mode='lines',
                    name=told, line={'color': colour, 'width': 1.6},
                    hovertemplate='%{y:.3f} N')
        )  # fmt: skip
    figure.update_xaxes(title_text='speed [m/s]')
    figure.update_yaxes(title_text='drag [N]')
    return figure.update_layout(showlegend=True, legend={'orientation': 'h', 'y': 1.08})
