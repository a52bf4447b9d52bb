"""Forces of the vehicle files: thrust, net forces at full command, drag, and the mass budget."""

from collections.abc import Mapping
import math
from typing import Final

from lta_config.constants import AIR_DENSITY
from lta_config.schema.comparison_file import load_comparison
from lta_config.typed import typed
from lta_energy.rotor import BENCH
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.drawing import blank
from lta_report.palette import LAMP, SOFT, TRUTH
from lta_studies.platforms.entries import entrant
from lta_studies.platforms.summary import margin
from lta_studies.reproduce.found import Asked, Found, Picture, Value
from lta_studies.reproduce.studies import pressure, tunnel
import numpy as np
from plotly.graph_objects import Figure, Scatter

NOT_IN_TABLE: Final = 'solar_panels'  # no row of the paper's table of masses
CURVE: Final = (
    "One rotor: the paper's polynomial, and Bitcraze's bench, whose voltage falls on the way. "
    'Both are of four motors, divided by four.'
)


def study(asked: Asked) -> Found:
    """Return what the vehicle files hold; chance has no part in it."""
    del asked
    vehicle, beavis, sweep = load_vehicle('gtmab'), beavises(), tunnel.shipped()
    values = {
        **thrust(vehicle), **forces(vehicle, beavis), **masses(vehicle), **drag(vehicle),
        **tunnel.fitted(sweep),
    }  # fmt: skip
    loading = vehicle.full_thrust / (math.pi * (pressure.PROPELLER / 2.0) ** 2)
    values |= {'disk_loading': Value(loading), **pressure.values(vehicle, loading)}
    command = typed('vehicle', 'show', 'gtmab')
    curve = Picture('thrust', 'Thrust of one rotor', CURVE, thrust_picture(vehicle), command)
    both = {'GT-MAB': vehicle, 'BEAVIS': beavis['beavis']}
    return Found(values, [curve, *tunnel.pictures(sweep, both), *pressure.pictures(values)])


def beavises() -> dict[str, Vehicle]:
    """Return BEAVIS as our tunnel has it, and as the paper's figure has it."""
    contestants = load_comparison('platforms').contestants
    return {
        name: entrant(contestants[name], AIR_DENSITY).vehicle
        for name in ('beavis', 'beavis_paper')
    }


def thrust(vehicle: Vehicle) -> dict[str, Value]:
    """Return full thrust of a rotor, and how far the bench is off."""
    a, b = vehicle.thrust_curve
    off = [row.thrust - (a * row.duty + b) * row.duty for row in BENCH]
    return {
        'full_thrust': Value(vehicle.full_thrust),
        'bench_off': Value(math.sqrt(sum(each * each for each in off) / len(off))),
    }


def forces(vehicle: Vehicle, beavis: Mapping[str, Vehicle]) -> dict[str, Value]:
    """Return net vertical and horizontal forces at full command, jets on the hull included."""
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
