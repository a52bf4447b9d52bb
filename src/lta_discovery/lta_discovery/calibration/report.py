# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a calibration."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any, Final

from lta_discovery.calibration.calibrated_file import CALIBRATED_FILE
from lta_discovery.calibration.corrections import is_contradicted
from lta_discovery.calibration.result import (
    CalibratedValue,
    Calibration,
    JudgedCorrection,
)
from lta_discovery.calibration.verdict import (
    format_forecast_sentence,
    format_headline,
    format_in_unit,
    format_inseparable,
    format_name,
    format_values,
    list_differences,
)
from lta_discovery.forecast_blocks import build_error_tables, build_error_tiles, draw_errors
from lta_discovery.formatting import (
    format_number,
    TO_DEG,
)
from lta_discovery.model.parameters import NET_LIFT_FORCE
from lta_discovery.state_filter.forecast_scores import (
    CALIBRATED,
    COASTING,
    ErrorRatio,
    FILE_MODEL,
    find_main_score,
    HorizonErrors,
)
from lta_report.formatting import Tile
from lta_report.json_value import to_json_value
from lta_report.report import Emphasis, Picture, Report, TextSection, TextTable

EFFECT_WORDS: Final = {
    'vehicle': 'mass and inertia',
    'wrench_gain': 'gain of the commands',
    'wrench_coupling': 'what commands do on other axes',
    'marker_offset': 'frame of the markers',
}  # effects that a reader knows by other words
FIRST_STEP: Final = 'Calibration: numbers beyond tolerance'
METHODS: Final = {
    'likelihood': 'all readings, with an unexplained force',
    'forecasts': 'forecasts, which follow something that the model lacks',
    'file': 'nothing forecasts the flights better than the file',
}
CALIBRATION_HEADS: Final = ('value', 'vehicle file', 'calibrated', '95 % interval', 'remark')
ALWAYS: Final = (
    'The heading of the tracker defines where the map points. Only a wind in the vehicle file, '
    'which is fixed to the room, shows it. The heading of the markers on the vehicle is fitted.',
    'All forces and masses together can be scaled: the gains hold for the mass that is stated '
    'here. Weigh the vehicle to fix them.',
    'Net lift is that of a flight: a payload, ballast, gas or the temperature change it alike.',
)
NEXT: Final = (
    'Next: lta discover with --vehicle {file} and flights that took no part finds what the file '
    'still lacks.'
)
ONLY_POSE: Final = (
    'Only poses were recorded, so the delay of the commands cannot be separated from the clock '
    'offset or the age of a pose.'
)


def build_report(calibration: Calibration, calibrated_file: str | None) -> Report:
    """Return the report; the vehicle file is None if it could not be written."""
    outputs = {} if calibrated_file is None else {CALIBRATED_FILE: calibrated_file}
    limits = [*ALWAYS]
    if calibration.find('clock_offset.offset') is None and not calibration.list_of_flights(
        'clock_offset.offset'
    ):
        limits.append(ONLY_POSE)
    keeps = not outputs or is_contradicted(calibration.scores)
    what_next = NEXT.format(file=calibration.vehicle if keeps else CALIBRATED_FILE)
    return Report(
        command='calibrate',
        subject=calibration.vehicle,
        headline=format_headline(calibration),
        introduction=(
            f'{format_forecast_sentence(calibration)} Calibrated are numbers that any vehicle '
            f'file must have, from wide assumptions. {what_next}'
        ),
        tiles=_build_tiles(calibration),
        blocks=(
            _build_value_table('Vehicle', [one for one in calibration.values if not one.flight]),
            *_build_flight_tables(calibration),
            *build_error_tables(calibration.scores),
            *build_correction_tables(calibration.worth),
            *_build_noise_tables(calibration),
            *_build_pictures(calibration),
            TextSection('What no flight separates', limits, bullets=True, printed=True),
            *(
                [TextSection('Warnings', calibration.warnings, bullets=True, printed=True)]
                if calibration.warnings
                else []
            ),
        ),
        data=to_json_value(
            {
                **encode_calibration(calibration),
                'corrections': encode_corrections(calibration.worth),
            }
        ),
        facts={
            'estimated from': METHODS[calibration.method],
            **{role: ', '.join(names) for role, names in calibration.bags.items() if names},
        },
        closing=(format_forecast_sentence(calibration), what_next),
        outputs=outputs,
    )


def _build_tiles(calibration: Calibration) -> list[Tile]:
    """Return the tiles: differences, and the forecast error."""
    # What a headline names: numbers of the vehicle, and the net lift of the flights
    far = {one.name for one in calibration.values if one.is_far}
    count = len(
        far & {NET_LIFT_FORCE, *(one.name for one in calibration.values if not one.flight)}
    )
    tile = Tile('Beyond tolerance', str(count), '', 'of the calibrated numbers, in bold')
    main = find_main_score(calibration.judging_scores[1])
    return [tile, *(build_error_tiles(main) if main else ())]


def _build_value_table(heading: str, values: Sequence[CalibratedValue]) -> TextTable:
    """Return the table of some values; those beyond tolerance are bold."""
    rows = []
    for one in sorted(values, key=lambda each: (not each.is_far, not each.is_known)):
        before, now, interval = format_in_unit(one)
        name = Emphasis(format_name(one)) if one.is_far else format_name(one)
        rows.append([name, before, now, interval, format_inseparable(one)])
    note = 'Bold: the vehicle file is off by more than its tolerance explains.'
    return TextTable(heading, CALIBRATION_HEADS, rows, note)


def build_first_step_table(calibration: Calibration) -> TextTable:
    """Return the table of a discovery's first step: differences, and the lift of each flight."""
    rows = []
    for one in calibration.values:
        lift = bool(one.flight) and one.name == NET_LIFT_FORCE
        if one.is_known and (lift or (one.is_far and not one.flight)):
            before, now, interval = format_in_unit(one)
            where = f', {one.flight}' if one.flight else ''
            rows.append([f'{format_name(one)}{where}', before, now, interval])
    return TextTable(FIRST_STEP, CALIBRATION_HEADS[:-1], rows)


def build_correction_tables(worth: Sequence[JudgedCorrection]) -> Iterator[TextTable]:
    """Yield the table of what each effect that was calibrated is worth."""
    rows = [
        [
            EFFECT_WORDS.get(effect := one.correction.effect, effect.replace('_', ' ')),
            ', '.join(format_values(one.correction)),
            format_ratio(one.ratio),
            'yes' if one.is_confirmed else 'no',
        ]
        for one in worth
    ]
    note = (
        "Position error of the calibrated vehicle by that with the vehicle file's values of an "
        'effect, and all other values as they are then most probable, without a new fit. '
        'Confirmed: the interval is below 1.'
    )
    if rows:
        heads = ('calibrated', 'clear values', 'error with it / without', 'confirmed')
        yield TextTable('What each part of the calibration is worth', heads, rows, note)


def format_ratio(one: ErrorRatio) -> str:
    """Return a ratio of errors with its interval, if it has one."""
    low, high = one.ci95
    ends = f' (95 %: {low:.2f} to {high:.2f})' if low == low else ''
    return f'{one.value:.2f}{ends}'


def _build_flight_tables(calibration: Calibration) -> list[TextTable]:
    """Return the table of what each flight has of its own; none if the flights do not tell it."""
    rows = []
    for one in calibration.values:
        if one.flight and one.is_known:
            before, now, interval = format_in_unit(one)
            rows.append([one.flight, format_name(one), before, now, interval])
    heads = ('flight', 'value', 'vehicle file', 'calibrated', '95 % interval')
    return [TextTable('Each flight', heads, rows)] if rows else []


def _build_noise_tables(calibration: Calibration) -> list[TextTable]:
    """Return the table of what each flight has that is not explained; none without a fit."""
    rows = []
    for name, one in calibration.noise.items():
        white, slow = one.white, one.correlated
        forces = ' '.join(format_number(1e3 * force, 2) for force in one.wrench[:3])
        rows.append(
            [
                name,
                f'{1e3 * white[0]:.2g} mm, {TO_DEG * white[3]:.2g}\N{DEGREE SIGN}',
                f'{1e3 * slow[0]:.2g} mm, {TO_DEG * slow[3]:.2g}\N{DEGREE SIGN}, '
                f'{one.correlation:.2g} s',
                f'{forces} mN, {one.memory[0]:.2g} s',
            ]
        )
    heads = ('flight', 'white error of a pose', 'slow error of a pose', 'unexplained force')
    note = (
        'Standard deviations, and times in which they change; the force along surge, sway and '
        'heave. Learned with the values above.'
    )
    return [TextTable('Noise', heads, rows, note)] if rows else []


def _build_pictures(calibration: Calibration) -> list[Picture]:
    """Return the figure of the forecast errors, if there are any."""
    role, scores = calibration.judging_scores
    where = 'confirming' if role == 'confirm' else 'training'
    return [draw_errors(scores, f'the {where} flights')] if scores else []


def _encode_score(one: HorizonErrors) -> dict[str, Any]:
    """Return a score as JSON data."""
    kinds = {'coast': COASTING, 'before': FILE_MODEL, 'after': CALIBRATED}
    errors = {key: one.errors[name]._asdict() for key, name in kinds.items()}
    least = one.least._asdict()
    return {'horizon_s': one.horizon, **errors, 'perfect': least, 'count': one.forecasts}


def encode_corrections(worth: Sequence[JudgedCorrection]) -> list[dict[str, Any]]:
    """Return what corrections are worth as JSON data."""
    return [
        {'effect': one.correction.effect, 'values': [each.name for each in one.correction.values],
         'error_ratio': one.ratio.value, 'ci95': one.ratio.ci95, 'confirmed': one.is_confirmed}
        for one in worth
    ]  # fmt: skip


def encode_calibration(calibration: Calibration) -> dict[str, Any]:
    """Return a calibration as JSON data, in SI units."""
    return {
        'vehicle': calibration.vehicle,
        'headline': format_headline(calibration),
        'method': calibration.method,
        'differences': list_differences(calibration),
        'values': [asdict(one) for one in calibration.values],
        'forecasts': {
            role: [_encode_score(one) for one in scores]
            for role, scores in calibration.scores.items()
        },
        'noise': {
            name: {
                'white': one.white[:6].tolist(),
                'correlated': one.correlated.tolist(),
                'correlation_s': one.correlation,
                'wrench': one.wrench.tolist(),
                'memory_s': one.memory.tolist(),
            }
            for name, one in calibration.noise.items()
        },
        'bags': {role: list(names) for role, names in calibration.bags.items()},
        'warnings': list(calibration.warnings),
    }
