"""Build the report of a calibration."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any, Final

from lta_discovery.calibration.calibrated_file import NAME
from lta_discovery.calibration.result import (
    AxisScore,
    CalibratedValue,
    Calibration,
    ForecastScore,
)
from lta_discovery.calibration.verdict import (
    format_error,
    format_forecast_sentence,
    format_headline,
    format_inseparable,
    list_differences,
)
from lta_discovery.model.parameters import is_calibration, NET_LIFT
from lta_discovery.page.formatting import (
    DEGREES,
    format_number,
    format_parameter,
    format_with_interval,
    SHOWN_UNITS,
)
from lta_report.formatting import Tile
from lta_report.report import Emphasis, Picture, Report, TextSection, TextTable
import plotly.graph_objects as go

FIRST_STEP: Final = 'Calibration: numbers any vehicle file must have'
METHODS: Final = {
    'likelihood': 'all readings, with an unexplained force',
    'both': 'forecasts; the intervals contain a fit to all readings, too',
    'forecasts': 'forecasts; the intervals are rough',
    'file': 'nothing forecasts the flights better than the file',
}
HEADS: Final = ('value', 'vehicle file', 'calibrated', '95 % interval', 'remark')
DIRECTIONS: Final = ('nose', 'side', 'up', 'length')  # as in `AxisScore`
ALWAYS: Final = (
    'The heading of the tracker defines where the map points. Only a wind in the vehicle file, '
    'which is fixed to the room, shows it. The heading of the markers on the vehicle is fitted.',
    'All forces and masses together can be scaled: the gains hold for the mass that is stated '
    'here. Weigh the vehicle to fix them.',
    'Net lift is that of a flight: a payload, ballast, gas or the temperature change it alike.',
)
ONLY_POSE: Final = (
    'Only poses were recorded, so the delay of the commands cannot be separated from the clock '
    'offset or the age of a pose.'
)


def build_report(calibration: Calibration, calibrated_file: str | None) -> Report:
    """Return the report; the vehicle file is None if it could not be written."""
    outputs = {} if calibrated_file is None else {NAME: calibrated_file}
    limits = [*ALWAYS]
    if calibration.find('clock_offset.offset') is None and not calibration.list_of_flights(
        'clock_offset.offset'
    ):
        limits.append(ONLY_POSE)
    return Report(
        command='calibrate',
        subject=calibration.vehicle,
        headline=format_headline(calibration),
        introduction=(
            'Calibrates numbers that any vehicle file must have, from wide assumptions. Effects '
            'that the model lacks are a matter for lta discover.'
        ),
        tiles=_build_tiles(calibration),
        blocks=(
            _build_value_table('Vehicle', [one for one in calibration.values if not one.flight]),
            *_build_flight_tables(calibration),
            _build_score_table(calibration.scores),
            *_build_axis_tables(calibration.axis_scores),
            *_build_pictures(calibration),
            TextSection('What no flight separates', limits, bullets=True, printed=True),
            *(
                [TextSection('Warnings', calibration.warnings, bullets=True, printed=True)]
                if calibration.warnings
                else []
            ),
        ),
        data=encode_calibration(calibration),
        facts={
            'estimated from': METHODS[calibration.method],
            **{role: ', '.join(names) for role, names in calibration.bags.items() if names},
        },
        closing=(format_forecast_sentence(calibration),),
        outputs=outputs,
    )


def _build_tiles(calibration: Calibration) -> list[Tile]:
    """Return the tiles: differences, and the forecast error."""
    scores = calibration.scores.get('confirm') or calibration.scores.get('train', ())
    count = sum(one.is_far for one in calibration.values)
    tiles = [Tile('Beyond tolerance', str(count), '', 'of the calibrated numbers, in bold')]
    if scores:
        last = scores[-1]
        for name, pair in (
            ('Vehicle file', last.before),
            ('Calibrated', last.after),
            ('Coasting', last.coast),
        ):
            value = format_number(100.0 * pair[0], 2)
            tiles.append(Tile(name, value, 'cm', f'position error {last.horizon:g} s ahead'))
    return tiles


def _format_in_unit(one: CalibratedValue) -> tuple[str, str, str]:
    """Return file value, value and interval with a unit that reads well."""
    unit, factor = SHOWN_UNITS.get(one.unit, (one.unit, 1.0))
    if one.unit == 'N':
        unit, factor = 'mN', 1e3
    elif one.unit == 'm':
        unit, factor = 'cm', 100.0
    elif one.unit == 'N/s':
        unit, factor = 'mN/min', 6e4
    before, value = factor * one.before, factor * one.value
    now, low, high = format_with_interval(value, (factor * one.ci95[0], factor * one.ci95[1]))
    end = '' if unit == '1' else f' {unit}'
    return f'{format_number(before)}{end}', f'{now}{end}', f'{low} to {high}'


def _format_name(one: CalibratedValue) -> str:
    effect, _, part = one.name.partition('.')
    if effect == 'vehicle':
        return 'mass (factor)' if part == 'mass' else f'inertia in {part} (factor)'
    if effect == 'helium_leak':
        return 'loss of lift'
    return format_parameter(one.name)


def _build_value_table(heading: str, values: Sequence[CalibratedValue]) -> TextTable:
    """Return the table of some values; those beyond tolerance are bold."""
    rows = []
    for one in sorted(values, key=lambda each: (not each.is_far, not each.is_known)):
        before, now, interval = _format_in_unit(one)
        name = Emphasis(_format_name(one)) if one.is_far else _format_name(one)
        rows.append([name, before, now, interval, format_inseparable(one)])
    note = 'Bold: the vehicle file is off by more than its tolerance explains.'
    return TextTable(heading, HEADS, rows, note)


def build_first_step_table(calibration: Calibration) -> TextTable:
    """Return the table of a discovery's first step: differences, and the lift of each flight."""
    rows = []
    for one in calibration.values:
        lift = bool(one.flight) and one.name == NET_LIFT
        if one.is_known and (lift or (one.is_far and not one.flight and is_calibration(one.name))):
            before, now, interval = _format_in_unit(one)
            where = f', {one.flight}' if one.flight else ''
            rows.append([f'{_format_name(one)}{where}', before, now, interval])
    return TextTable(FIRST_STEP, HEADS[:-1], rows)


def _build_flight_tables(calibration: Calibration) -> list[TextTable]:
    """Return the table of what each flight has of its own; none if the flights do not tell it."""
    rows = []
    for one in calibration.values:
        if one.flight and one.is_known:
            before, now, interval = _format_in_unit(one)
            rows.append([one.flight, _format_name(one), before, now, interval])
    heads = ('flight', 'value', 'vehicle file', 'calibrated', '95 % interval')
    return [TextTable('Each flight', heads, rows)] if rows else []


def _build_score_table(scores: Mapping[str, Sequence[ForecastScore]]) -> TextTable:
    """Return the table of forecast errors."""
    rows = []
    for role, each in scores.items():
        for one in each:
            cells = []
            for pair in (one.coast, one.before, one.after):
                turn = format_number(DEGREES * pair[1])
                cells.append(f'{format_error(pair[0], 3)}, {turn}\N{DEGREE SIGN}')
            rows.append([f'{role}, {one.horizon:g} s', *cells, str(one.pieces)])
    heads = ('flights and horizon', 'coasting', 'vehicle file', 'calibrated', 'forecasts')
    note = (
        'RMS errors of position and attitude. The net lift of a confirming flight is the mean of '
        'the training flights, corrected by its own earlier forecasts.'
    )
    return TextTable('Forecasts', heads, rows, note)


def _build_axis_tables(scores: Mapping[str, Sequence[AxisScore]]) -> list[TextTable]:
    """Return the table of position errors by direction; none if the flights are too short."""
    rows = []
    for role, each in scores.items():
        for one in each:
            sides = zip(DIRECTIONS, one.coast, one.before, one.after, strict=True)
            for name, *errors in sides:
                cells = [format_error(error, 3) for error in errors]
                rows.append([f'{role}, {one.horizon:g} s', name, *cells, str(one.pieces)])
    heads = ('flights and horizon', 'direction', 'coasting', 'vehicle file', 'calibrated')
    note = (
        'RMS position errors by the heading in which each forecast begins. A turn that no model '
        'knows of moves an error from the nose to the side, but hardly changes the length of the '
        'way along the floor.'
    )
    return [TextTable('Forecasts by direction', (*heads, 'forecasts'), rows, note)] if rows else []


def _build_pictures(calibration: Calibration) -> list[Picture]:
    """Return the figure of the forecast errors, if there are any."""
    role = 'confirm' if calibration.scores.get('confirm') else 'train'
    scores = calibration.scores.get(role, ())
    if not scores:
        return []
    figure = go.Figure()
    for name, key in (
        ('coasting', 'coast'),
        ('vehicle file', 'before'),
        ('calibrated', 'after'),
    ):
        x = [one.horizon for one in scores]
        y = [100.0 * getattr(one, key)[0] for one in scores]
        figure.add_scatter(x=x, y=y, name=name, mode='lines+markers')
    figure.update_xaxes(title='time ahead [s]')
    figure.update_yaxes(
        title='position error [cm]', type='log',
        tickvals=[0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500],
    )  # fmt: skip
    caption = f'RMS over all forecasts of the {role} flights.'
    return [Picture('forecasts', 'Forecast errors', caption, figure)]


def encode_calibration(calibration: Calibration) -> dict[str, Any]:
    """Return a calibration as JSON data, in SI units."""
    return {
        'vehicle': calibration.vehicle,
        'headline': format_headline(calibration),
        'method': calibration.method,
        'differences': list_differences(calibration),
        'values': [asdict(one) for one in calibration.values],
        'forecasts': {
            role: [asdict(one) for one in scores] for role, scores in calibration.scores.items()
        },
        'directions': {
            role: [asdict(one) for one in scores]
            for role, scores in calibration.axis_scores.items()
        },
        'bags': {role: list(names) for role, names in calibration.bags.items()},
        'warnings': list(calibration.warnings),
    }
