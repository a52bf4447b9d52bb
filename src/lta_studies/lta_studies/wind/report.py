# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of the wind limits."""

from collections.abc import Sequence
from functools import partial
import math
from typing import Final

from lta_config.command_line import format_lta_command
from lta_model.vehicle import load_vehicle
from lta_report.charts import ChartAxis, Curve, draw_curves, item_colour, Level
from lta_report.formatting import MISSING, Tile
from lta_report.report import Picture, Report, TextSection, TextTable
from lta_report.result_table import build_table, Column
from lta_sim import wind_limits
from lta_studies.wind.limits import LIMIT_DRAWS, PlatformWindLimits, to_json, WindRequest
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure

TOP_WIND: Final = 20.0  # m/s, of the axis
PAPER_WINDS: Final = ((8.0, 'paper: BAG converges'), (14.0, 'paper: all fail'))
PLOTTED_ROUGHNESS: Final = np.geomspace(1e-3, 0.45, 60)  # m
ROUGHNESS_TICKS: Final = (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3)  # m
WIND_CAPTION: Final = (
    'The limit, as wind at the reference height; the log law, averaged over the hull, gives the '
    'wind at the hull. Towards the right, the hull flies between the obstacles that make the '
    'ground rough, where the log law is only an approximation: compare several values.'
)
WIND_METHOD: Final = (
    'The limit is the lowest of three airspeeds: the highest that the rotors can hold at '
    'constant height and heading, the one above which the hull tumbles, and the one above '
    'which it rises because rotors below the hull lift its nose and then push it up. Dash: no '
    'such limit. Whether a strategy finds its lamp in such a wind, flights tell: lta sweep '
    'light_uniform_winds.'
)
WIND_ABOUT: Final = (
    'Limits in uniform wind, and in wind over rough ground. The wind over ground is given at '
    '{reference:g} m, as a weather service measures it; the log law yields the wind at the height '
    'of the hull.'
)


def build_report(results: Sequence[PlatformWindLimits], request: WindRequest) -> Report:
    """Return the report of the wind limits."""
    return Report(
        command='wind',
        subject='',
        headline=format_headline(results),
        introduction=WIND_ABOUT.format(reference=request.reference),
        tiles=build_tiles(results),
        blocks=(
            Picture(
                'wind', 'Flyable wind against the roughness of the ground', WIND_CAPTION,
                draw_limits(results, request), height=460,
            ),
            build_limit_table(results, request),
            TextSection('Remarks', (WIND_METHOD, *format_platform_notes(results))),
        ),
        data=to_json(results, request),
        facts={
            'hull centre': f'{request.height:g} m above the floor; higher if the vehicle is too '
            'large',
            'reference height': f'{request.reference:g} m',
        },
        commands=list_commands(request),
        closing=format_platform_notes(results),
    )  # fmt: skip


def format_headline(results: Sequence[PlatformWindLimits]) -> str:
    """Return the headline."""
    limited = [each for each in results if math.isfinite(each.static)]
    if not limited:
        return 'No wind limit was found.'
    best = max(limited, key=lambda each: each.static)
    among = f', the highest limit of {len(limited)} platforms' if len(limited) > 1 else ''
    # The limit of one platform is the speed at which thrust, tumbling or rising ends it
    why = '' if among else f'; {_find_cause(best)} limits it'
    return (
        f'In uniform wind {best.name} can statically hold its position up to {best.static:.2f} '
        f'm/s{among}{why}.'
    )


def _find_cause(limit: PlatformWindLimits) -> str:
    """Return what sets the static limit."""
    causes = {limit.thrust: 'thrust', limit.tumble: 'tumbling', limit.rise: 'rising'}
    return causes[min(causes)]


def build_tiles(results: Sequence[PlatformWindLimits]) -> list[Tile]:
    """Return a tile with the limit in uniform wind for each platform."""
    return [
        Tile(each.name, format_speed(each.static), 'm/s', f'limited by {_find_cause(each)}')
        if math.isfinite(each.static)
        else Tile(each.name, format_speed(each.static), '', 'no known limit')
        for each in results
    ]


def format_platform_notes(results: Sequence[PlatformWindLimits]) -> list[str]:
    """Return the notes on single platforms."""
    notes = [_format_interval(each) for each in results if each.interval is not None]
    return notes + [f'{each.name}: {each.note}' for each in results if each.note]


def _format_interval(limit: PlatformWindLimits) -> str:
    """Return the interval of a static limit in a sentence."""
    assert limit.interval is not None
    low, high = limit.interval
    munk = load_vehicle(limit.name).collect_effects().get('munk_moment', {})
    ideal = (
        ''
        if munk
        else ' No flow at incidence is known: the Munk moment is that of an ideal fluid.'
    )
    return (
        f'{limit.name}: with the numbers of its file drawn from their ranges, the limit in '
        f'uniform wind, which is its top speed in level flight, is {low:.2f} to {high:.2f} m/s '
        f'({LIMIT_DRAWS} draws, 5 to 95 %).{ideal}'
    )


def format_speed(value: float) -> str:
    """Format a speed without its unit; a dash if there is no limit."""
    return f'{value:.2f}' if math.isfinite(value) else MISSING


def build_limit_table(results: Sequence[PlatformWindLimits], request: WindRequest) -> TextTable:
    """Return the table of limits, with a column for each ground."""
    columns: list[Column[PlatformWindLimits]] = [
        Column('name', 'platform'),
        Column('height', 'hull height', 'm', 2),
        Column('thrust', 'rotors hold', 'm/s', 2),
        Column('tumble', 'tumbles above', 'm/s', 2),
        Column('rise', 'rises above', 'm/s', 2),
        # Near the ground it is calm: 10 m/s of the weather service may be 1 m/s at the hull
        Column('static', 'limit at the hull', 'm/s', 2),
    ]
    for k, z in enumerate(request.roughness):
        columns.append(Column('', f'roughness {z:g} m', 'm/s', 2, partial(_limit_over, k)))
    groups = (('', 6), (f'wind at {request.reference:g} m', len(request.roughness)))
    return build_table('Limits by platform', columns, results, groups=groups)


def _limit_over(place: int, limit: PlatformWindLimits) -> float:
    """Return the limit over one ground, by its place among the grounds [m/s]."""
    return limit.over[place].static


def list_commands(request: WindRequest) -> dict[str, str]:
    """Return the command that flies in such a wind."""
    return {
        'Fly in such a wind': format_lta_command(
            'simulate', '--vehicle', request.vehicles[0], '--scenario', 'windy_field', '--set',
            'scenario.air.profile.wind=3 m/s',
        ),
        'Fly in many winds': format_lta_command('sweep', 'light_uniform_winds'),
    }  # fmt: skip


def draw_limits(results: Sequence[PlatformWindLimits], request: WindRequest) -> Figure:
    """Plot the limits as reference wind against the roughness of the ground."""
    curves = []
    for k, limit in enumerate(results):
        if not 0.0 < limit.static < math.inf:
            continue
        wind = limit_curve(limit, request)
        curves.append(Curve(limit.name, PLOTTED_ROUGHNESS, wind, item_colour(k), '%{y:.1f} m/s',
                            label=limit.name))  # fmt: skip
    return draw_curves(
        curves,
        ChartAxis('roughness of the ground [m]', log=True, ticks=ROUGHNESS_TICKS),
        ChartAxis(
            f'wind at {request.reference:g} m above the ground [m/s]', range=(0.0, TOP_WIND)
        ),
        levels=[Level(speed, f'{speed:g} m/s, {text}') for speed, text in PAPER_WINDS],
    )


def limit_curve(limit: PlatformWindLimits, request: WindRequest) -> NDArray[np.float64]:
    """Return the static limit as reference wind over each roughness [m/s]."""
    vehicle = load_vehicle(limit.name)
    shares = [
        wind_limits.wind_share_at_hull(vehicle, limit.height, request.reference, float(z))
        for z in PLOTTED_ROUGHNESS
    ]
    # Where the roughness elements are taller than the hull, the log law gives no wind.
    return np.array([limit.static / share if share > 0.0 else math.nan for share in shares])
