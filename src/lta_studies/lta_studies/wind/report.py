# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of the wind limits."""

from collections.abc import Sequence
import math
from typing import Final

from lta_config.command_line import format_lta_command
from lta_model.vehicle import load_vehicle
from lta_report.charts import ChartAxis, Curve, draw_curves, item_colour, Level
from lta_report.formatting import format_count, MISSING, Tile
from lta_report.report import Picture, Report, STOPPED, TextSection, TextTable
from lta_report.result_table import build_table, Column
from lta_sim import wind_limits
from lta_studies.wind.flyable_wind import FlyableWind
from lta_studies.wind.limits import LIMIT_DRAWS, PlatformWindLimits, to_json, WindStudyRequest
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure

TOP_WIND: Final = 20.0  # m/s, of the axis
PAPER_WINDS: Final = ((8.0, 'paper: BAG converges'), (14.0, 'paper: all fail'))
PLOTTED_ROUGHNESS: Final = np.geomspace(1e-3, 0.45, 60)  # m
ROUGHNESS_TICKS: Final = (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3)  # m
WIND_CAPTION: Final = (
    'Lines: static limit, as wind at the reference height; the log law, averaged over the '
    'hull, gives the wind at the hull. Dots: flown in the closed loop. Towards the right, '
    'the hull flies between the obstacles that make the ground rough, where the log law is '
    'only an approximation: compare several values.'
)
WIND_METHOD: Final = (
    'Static limit: the lowest of three airspeeds: the highest that the rotors can hold at '
    'constant height and heading, the one above which the hull tumbles, and the one above '
    'which it rises because rotors below the hull lift its nose and then push it up. Flown '
    'limit: the largest wind, blowing from the lamp to the start, in which the drone still '
    'approaches the lamp with its own gains and the best of several airspeeds. In brackets: '
    'the additional wind at which it failed. "none": no approach even in the smallest wind '
    'tried. Dash: no such limit, or not flown.'
)


def build_report(results: Sequence[PlatformWindLimits], request: WindStudyRequest) -> Report:
    """Return the report of a wind study; of one that Ctrl-C stopped, its finished platforms."""
    done, count = len(results), len(request.vehicles)
    unfinished = f' Stopped after {done} of {count} platforms.' if done < count else ''
    return Report(
        command='wind',
        subject=request.scenario,
        headline=format_headline(results),
        introduction=format_introduction(request) + unfinished,
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
        facts=build_provenance_table(request),
        commands=list_commands(request),
        closing=[*format_platform_notes(results), *([unfinished.strip()] if unfinished else [])],
        status=STOPPED if unfinished else 0,
    )  # fmt: skip


def format_headline(results: Sequence[PlatformWindLimits]) -> str:
    """Return the headline."""
    winds = {each.name: each.flown.wind for each in results if each.flown is not None}
    how = 'makes headway' if winds else 'can statically hold its position'
    most = winds or {each.name: each.static for each in results if math.isfinite(each.static)}
    if not most:
        return 'No wind limit was found.'
    best = max(most, key=lambda name: most[name])
    among = f', the highest limit of {len(most)} platforms' if len(most) > 1 else ''
    (limit,) = [each for each in results if each.name == best]
    # The static limit of one platform is the speed at which thrust, tumbling or rising ends it
    why = '' if winds or among else f'; {_find_cause(limit)} limits it'
    return f'In uniform wind {best} {how} up to {most[best]:.2f} m/s{among}{why}.'


def _find_cause(limit: PlatformWindLimits) -> str:
    """Return what sets the static limit."""
    causes = {limit.thrust: 'thrust', limit.tumble: 'tumbling', limit.rise: 'rising'}
    return causes[min(causes)]


def format_introduction(request: WindStudyRequest) -> str:
    """Describe the wind profiles and the flights."""
    seeds = format_count(request.seeds, 'seed')
    note = f'Flown with {seeds}{", in coarse steps" if request.quick else ""}.'
    return (
        'Limits in uniform wind, and in wind over rough ground. The wind over ground is '
        f'given at {request.reference:g} m, as a weather service measures it; the log law '
        'yields the wind at the height of the hull. '
        f'{note if request.fly else "Static limits only; nothing was flown."}'
    )


def build_tiles(results: Sequence[PlatformWindLimits]) -> list[Tile]:
    """Return a tile with the limit in uniform wind for each platform."""
    tiles = []
    for each in results:
        numbers = format_speed(each.static)
        cause = _find_cause(each)
        why = f'{cause} allows {numbers}' if math.isfinite(each.static) else 'no known limit'
        if each.flown is None:
            is_finite = math.isfinite(each.static)
            note = f'static; limited by {cause}' if is_finite else why
            tiles.append(Tile(each.name, numbers, 'm/s' if is_finite else '', note))
        else:
            tiles.append(
                Tile(each.name, format_flyable_wind(each.flown, False), 'm/s', f'flown; {why}')
            )
    return tiles


def format_platform_notes(results: Sequence[PlatformWindLimits]) -> list[str]:
    """Return the notes on single platforms."""
    notes = [
        f'{each.name}: the best airspeed command in uniform wind was {each.flown.airspeed:g} m/s.'
        for each in results
        if each.flown is not None
    ]
    notes += [_format_interval(each) for each in results if each.interval is not None]
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
        f'{limit.name}: with the numbers of its file drawn from their ranges, the static limit in '
        f'uniform wind, which is its top speed in level flight, is {low:.2f} to {high:.2f} m/s '
        f'({LIMIT_DRAWS} draws, 5 to 95 %).{ideal}'
    )


def format_speed(value: float) -> str:
    """Format a speed without its unit; a dash if there is no limit."""
    return f'{value:.2f}' if math.isfinite(value) else MISSING


def format_flyable_wind(limit: FlyableWind | None, bracket: bool = True) -> str:
    """Format a flown limit with its bracket; a dash if nothing was flown."""
    if limit is None:
        return MISSING
    if limit.wind <= 0.0:
        return 'none'
    return f'{limit.wind:.2f}' + (f' (+{limit.fine:.2f})' if bracket else '')


def list_ground_columns(place: int) -> list[Column[PlatformWindLimits]]:
    """Return the columns of the limits over one ground, by its place among the grounds."""
    return [
        Column('', 'static', 'm/s', 2, lambda each: each.over[place].static),
        Column('', 'flown [m/s]', of=lambda each: format_flyable_wind(each.over[place].flown)),
    ]


def build_limit_table(
    results: Sequence[PlatformWindLimits], request: WindStudyRequest
) -> TextTable:
    """Return the table of limits, with two columns for each ground."""
    # Near the ground it is calm: 10 m/s of the weather service may be 1 m/s at the hull
    grounds = [
        'wind at the hull',
        *(f'wind at {request.reference:g} m, roughness {z:g} m' for z in request.roughness),
    ]
    columns: list[Column[PlatformWindLimits]] = [
        Column('name', 'platform'),
        Column('height', 'hull height', 'm', 2),
        Column('thrust', 'rotors hold', 'm/s', 2),
        Column('tumble', 'tumbles above', 'm/s', 2),
        Column('rise', 'rises above', 'm/s', 2),
        Column('static', 'static', 'm/s', 2),
        Column('', 'flown [m/s]', of=lambda each: format_flyable_wind(each.flown)),
    ]
    for k in range(len(request.roughness)):
        columns += list_ground_columns(k)
    groups = (('', 5), *((name, 2) for name in grounds))
    return build_table('Limits by platform', columns, results, groups=groups)


def build_provenance_table(request: WindStudyRequest) -> dict[str, str]:
    """Return the provenance table of the page."""
    return {
        'scenario': f'{request.scenario}, its wind replaced',
        'hull centre': f'{request.height:g} m above the floor; higher if the vehicle is too large',
        'reference height': f'{request.reference:g} m',
        'seeds': ('1' if request.seeds == 1 else f'1 to {request.seeds}')
        if request.fly
        else 'none: nothing was flown',
    }


def list_commands(request: WindStudyRequest) -> dict[str, str]:
    """Return the command that flies in such a wind."""
    first = request.vehicles[0]
    return {
        'Fly in such a wind': format_lta_command(
            'simulate', '--vehicle', first, '--scenario', request.scenario, '--set',
            'scenario.air.profile.wind=3 m/s',
        ),
    }  # fmt: skip


def draw_limits(results: Sequence[PlatformWindLimits], request: WindStudyRequest) -> Figure:
    """Plot the limits as reference wind against the roughness of the ground."""
    curves = []
    for k, limit in enumerate(results):
        if not 0.0 < limit.static < math.inf:
            continue
        wind = limit_curve(limit, request)
        curves.append(Curve(limit.name, PLOTTED_ROUGHNESS, wind, item_colour(k), '%{y:.1f} m/s',
                            label=limit.name))  # fmt: skip
        points = [(over.roughness, over.flown.wind) for over in limit.over if over.flown]
        if points:
            grounds, winds = zip(*points, strict=True)
            curves.append(
                Curve(
                    f'{limit.name}, flown', grounds, winds, item_colour(k),
                    '%{y:.1f} m/s flown', 'markers',
                )
            )  # fmt: skip
    return draw_curves(
        curves,
        ChartAxis('roughness of the ground [m]', log=True, ticks=ROUGHNESS_TICKS),
        ChartAxis(
            f'wind at {request.reference:g} m above the ground [m/s]', range=(0.0, TOP_WIND)
        ),
        levels=[Level(speed, f'{speed:g} m/s, {text}') for speed, text in PAPER_WINDS],
    )


def limit_curve(limit: PlatformWindLimits, request: WindStudyRequest) -> NDArray[np.float64]:
    """Return the static limit as reference wind over each roughness [m/s]."""
    vehicle = load_vehicle(limit.name)
    shares = [
        wind_limits.wind_share_at_hull(vehicle, limit.height, request.reference, float(z))
        for z in PLOTTED_ROUGHNESS
    ]
    # Where the roughness elements are taller than the hull, the log law gives no wind.
    return np.array([limit.static / share if share > 0.0 else math.nan for share in shares])
