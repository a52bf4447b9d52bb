"""The flyable wind as one self-contained page, in the look of a flight's page."""

from collections.abc import Sequence
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_config.typed import typed
from lta_model.vehicle import load_vehicle
from lta_report.drawing import blank, Label, label_ends
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.palette import ESTIMATE, GOOD, LAMP, SETPOINT, SOFT, TIME, TRUTH, WALL
from lta_report.pieces import section, tile_html
from lta_sim import wind_limits
from lta_studies.wind.limits import Asked, Limits
from lta_studies.wind.trial import Flyable
import numpy as np
from numpy.typing import NDArray
from plotly.graph_objects import Figure, Scatter

COLOURS: Final = (TRUTH, ESTIMATE, GOOD, LAMP, SETPOINT, TIME[0], TIME[2], TIME[3])
PAPER_WINDS: Final = ((8.0, 'paper: BAG converges'), (14.0, 'paper: all fail'))
ROUGHNESS: Final = np.geomspace(1e-3, 0.45, 60)
TICKS: Final = (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3)  # m
MISSING: Final = '\N{EN DASH}'
CAPTION: Final = (
    'Lines: the reference wind that thrust and balance allow at the hull, by the log law, '
    'averaged over the hull. Dots: flown in the closed loop. Between the elements of the '
    'roughness, towards the right, the log law is a surrogate only: compare several.'
)
METHOD: Final = (
    'By numbers: the least of the airspeed that the rotors hold at constant height and heading, '
    'the one above which the hull tumbles, and the one above which it rises: rotors below it lift '
    'its nose, and then push it up. Flown: the most wind, from the lamp to the start, '
    'in which the drone still makes way to the lamp by its own gains, told the best of several '
    'airspeeds; in brackets, how much more was too much. None: no way in the least wind that was '
    'tried. A dash: there is no such limit, or it was not flown.'
)


def write_page(found: Sequence[Limits], asked: Asked, out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(found, asked), out)


def page(found: Sequence[Limits], asked: Asked) -> str:
    """Return the whole page."""
    return framed(
        'wind.html',
        title=escape(title(found)),
        kicker=escape(f'wind · {asked.scenario}'),
        about=escape(about(asked)),
        tiles='\n'.join(tile_html(*each) for each in tiles(found)),
        table=table_html(found, asked),
        notes=''.join(f'<p class="note">{escape(each)}</p>' for each in (METHOD, *notes(found))),
        picture=section(
            'wind', 'Flyable wind against the roughness of the ground', CAPTION,
            picture(found, asked),
        ),
        facts=facts(asked),
        commands=commands(asked),
    )  # fmt: skip


def title(found: Sequence[Limits]) -> str:
    """Return what came out, in a sentence."""
    flown = {each.name: each.flown.wind for each in found if each.flown is not None}
    how = 'makes way' if flown else 'can stand, by its numbers,'
    most = flown or {each.name: each.static for each in found if math.isfinite(each.static)}
    if not most:
        return 'No limit of the wind was found.'
    best = max(most, key=lambda name: most[name])
    among = f', the most of {len(most)} platforms' if len(most) > 1 else ''
    return f'In uniform wind {best} {how} up to {most[best]:.2f} m/s{among}.'


def about(asked: Asked) -> str:
    """Return what the wind is, in two sentences."""
    seeds = f'{asked.seeds} seed{"s" if asked.seeds > 1 else ""}'
    flown = f'Flown with {seeds}{", in coarse steps" if asked.quick else ""}.'
    return (
        f'Uniform wind, and wind that a weather service would measure at {asked.reference:g} m '
        'over rough ground, of which the hull meets the part that the log law leaves at its own '
        f'height. {flown if asked.fly else "By numbers alone; nothing was flown."}'
    )


def tiles(found: Sequence[Limits]) -> list[Tile]:
    """Return the uniform wind of each platform."""
    made = []
    for each in found:
        numbers = speed(each.static)
        causes = {each.thrust: 'thrust', each.tumble: 'tumbling', each.rise: 'rising'}
        cause = causes[min(causes)]
        why = f'{cause} allows {numbers}' if math.isfinite(each.static) else 'no known limit'
        if each.flown is None:
            known = math.isfinite(each.static)
            note = f'by numbers; {cause} sets it' if known else why
            made.append(Tile(each.name, numbers, 'm/s' if known else '', note))
        else:
            made.append(Tile(each.name, flight(each.flown, False), 'm/s', f'flown; {why}'))
    return made


def notes(found: Sequence[Limits]) -> list[str]:
    """Return what belongs to single platforms."""
    told = [
        f'{each.name}: in uniform wind it flew best when told {each.flown.airspeed:g} m/s of '
        'airspeed.'
        for each in found
        if each.flown is not None
    ]
    return told + [f'{each.name}: {each.note}' for each in found if each.note]


def speed(value: float) -> str:
    """Return a speed, without its unit; a dash where there is no limit."""
    return f'{value:.2f}' if math.isfinite(value) else MISSING


def flight(flown: Flyable | None, bracket: bool = True) -> str:
    """Return a flown limit with what was too much; a dash where nothing was flown."""
    if flown is None:
        return MISSING
    if flown.wind <= 0.0:
        return 'none'
    return f'{flown.wind:.2f}' + (f' (+{flown.fine:.2f})' if bracket else '')


def table_html(found: Sequence[Limits], asked: Asked) -> str:
    """Return all limits, each ground with its two columns."""
    grounds = ['uniform wind', *(f'over {z:g} m of roughness' for z in asked.roughness)]
    top = ''.join(f'<th scope="colgroup" colspan="2">{name}</th>' for name in grounds)
    heads = [
        'platform',
        'hull at [m]',
        'rotors hold [m/s]',
        'tumbles above [m/s]',
        'rises above [m/s]',
    ]
    heads += ['by numbers [m/s]', 'flown [m/s]'] * len(grounds)
    lines = []
    for each in found:
        cells = [f'{each.height:.2f}', *map(speed, (each.thrust, each.tumble, each.rise))]
        cells += [speed(each.static), flight(each.flown)]
        for over in each.over:
            cells += [speed(over.static), flight(over.flown)]
        own = ''.join(f'<td>{escape(cell)}</td>' for cell in cells)
        lines.append(f'<tr><th scope="row">{escape(each.name)}</th>{own}</tr>')
    second = ''.join(f'<th scope="col">{head}</th>' for head in heads)
    return (
        '<table class="limits"><caption class="hidden">Flyable wind of each platform</caption>'
        f'<thead><tr class="grounds"><td colspan="5"></td>{top}</tr><tr>{second}</tr></thead>'
        f'<tbody>{"".join(lines)}</tbody></table>'
    )


def facts(asked: Asked) -> dict[str, str]:
    """Return where the limits come from."""
    return {
        'scenario': f'{asked.scenario}, its wind replaced',
        'hull centre': f'{asked.height:g} m up, or as high as the vehicle stands and a little',
        'reference height': f'{asked.reference:g} m',
        'seeds': ('1' if asked.seeds == 1 else f'1 to {asked.seeds}')
        if asked.fly
        else 'none: nothing was flown',
        'commit': commit(),
    }


def commands(asked: Asked) -> dict[str, str]:
    """Return how to find it again, and how to go on."""
    rough = [word for z in asked.roughness for word in ('--roughness', f'{z:g}')]
    how = ['--quick'] if asked.quick else ['--seeds', str(asked.seeds)]
    how = how if asked.fly else ['--no-fly']
    first = asked.vehicles[0]
    return {
        'Find it again': typed(
            'wind', *asked.vehicles, *rough, '--height', f'{asked.height:g}', '--reference',
            f'{asked.reference:g}', '--scenario', asked.scenario, *how,
        ),
        'Fly in such a wind': typed(
            'simulate', '--vehicle', first, '--scenario', asked.scenario, '--set',
            'scenario.air.profile.wind=3 m/s',
        ),
    }  # fmt: skip


def picture(found: Sequence[Limits], asked: Asked) -> Figure:
    """Return the limit as reference wind against the roughness of the ground."""
    figure = blank()
    labels = []
    for k, limit in enumerate(found):
        colour = COLOURS[k % len(COLOURS)]
        if not 0.0 < limit.static < math.inf:
            continue
        wind = curve(limit, asked)
        labels.append(Label(limit.name, float(np.nan_to_num(wind[-1], nan=20.0)), colour))
        figure.add_trace(
            Scatter(
                x=ROUGHNESS, y=wind, mode='lines', name=limit.name,
                line={'color': colour, 'width': 1.6}, hovertemplate='%{y:.1f} m/s',
            )
        )  # fmt: skip
        flown = [(over.roughness, over.flown.wind) for over in limit.over if over.flown]
        if flown:
            figure.add_trace(
                Scatter(
                    x=[z for z, _ in flown], y=[wind for _, wind in flown], mode='markers',
                    name=f'{limit.name}, flown', marker={'color': colour, 'size': 8},
                    hovertemplate='%{y:.1f} m/s flown',
                )
            )  # fmt: skip
    for speed, text in PAPER_WINDS:
        figure.add_shape(
            type='line', x0=0.0, x1=1.0, xref='paper', y0=speed, y1=speed, layer='below',
            line={'color': WALL, 'width': 1, 'dash': '2px,3px'},
        )  # fmt: skip
        figure.add_annotation(
            x=0.0, xref='paper', y=speed, yanchor='bottom', xanchor='left',
            text=f'{speed:g} m/s, {text}', font={'size': 10, 'color': SOFT},
        )  # fmt: skip
    figure.update_xaxes(
        type='log', title_text='roughness of the ground [m]', tickvals=TICKS,
        ticktext=[f'{each:g}' for each in TICKS],
    )  # fmt: skip
    figure.update_yaxes(title_text=f'wind at {asked.reference:g} m above the ground [m/s]')
    label_ends(figure, labels, (0.0, 20.0))
    return figure


def curve(limit: Limits, asked: Asked) -> NDArray[np.float64]:
    """Return the reference wind that a platform can stand against over each roughness. [m/s]"""
    vehicle = load_vehicle(limit.name)
    shares = [
        wind_limits.share_at_hull(vehicle, limit.height, asked.reference, float(z))
        for z in ROUGHNESS
    ]
    # Where the roughness reaches over the hull, the log law leaves no wind to speak of.
    return np.array([limit.static / share if share > 0.0 else math.nan for share in shares])
