# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a discovery: what is missing, what it is worth, and where it acts."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

from lta_discovery.calibration.calibrated_file import CALIBRATED_FILE
from lta_discovery.calibration.report import (
    build_correction_tables,
    build_first_step_table,
    encode_calibration,
    encode_corrections,
    format_ratio,
)
from lta_discovery.discovery.conclusion import Conclusion, format_names
from lta_discovery.discovery.figures import build_pictures
from lta_discovery.discovery.study import (
    CLOSEST,
    Discovery,
    NAMED,
    NamedElement,
    TUNED,
    WRITTEN,
)
from lta_discovery.flights.measured_flight import GRID_PERIOD
from lta_discovery.flights.outliers import ExcludedInterval
from lta_discovery.forecast_blocks import build_error_tables, build_error_tiles, draw_errors
from lta_discovery.formatting import (
    append_unit,
    explain_effect,
    format_number,
    format_parameter,
    format_with_interval,
    join_words,
    SHOWN_UNITS,
)
from lta_discovery.state_filter.forecast_scores import COASTING, FILE_MODEL, HorizonErrors
from lta_discovery.state_filter.noise_model import average_noise, wrench_floor
from lta_model.effects.protocol import AXES
from lta_report.formatting import Tile
from lta_report.json_value import to_json_value
from lta_report.report import Picture, Report, ReportSection, TextSection, TextTable

REPORT_SCHEMA: Final = 1  # of discovery.json
LEAST_PROBABILITY: Final = 0.02  # of an element that the table of candidates lists
ROLES: Final = {'train': 'learned from', 'confirm': 'learned from', 'holdout': 'held out'}


def build_report(
    study: Discovery,
    conclusion: Conclusion,
    name: str,
    cuts: Sequence[ExcludedInterval],
    warnings: Sequence[str],
) -> Report:
    """
    Return the report of a study.

    `name`: of the vehicle, as the user gave it. `cuts`, `warnings`: parts of the recordings that
    are not used, and what else limits the data.
    """
    words = [*warnings, *study.warnings]
    return Report(
        command='discover',
        subject=name,
        headline=conclusion.headline,
        introduction=' '.join([*conclusion.details, conclusion.advice]),
        tiles=list(_build_tiles(study)),
        blocks=(
            *_build_calibration_tables(study),
            *build_correction_tables(study.corrections),
            *_build_named_tables(study),
            *_build_forecast_blocks(study),
            *build_pictures(study),
            ReportSection('What was considered', list(_build_details(study)), folded=True),
            *([TextSection('Warnings', words, bullets=True, printed=True)] if words else []),
        ),
        data=to_json_value(_encode(study, conclusion, name, cuts, words)),
        facts={
            'flights': '; '.join(f'{one}: {ROLES[study.flights[one][0]]}' for one in study.flights)
        },
        closing=(*conclusion.details, conclusion.advice),
        json_name='discovery.json',
    )  # fmt: skip


def _build_tiles(study: Discovery) -> Iterator[Tile]:
    """Yield how many things are missing, and the errors of forecasts."""
    least = min((one.present.gain for one in study.named), default=0.0)
    yield Tile(
        'Missing', str(len(study.named)), '',
        f'the least certain by {format_number(least)} nats' if study.named else 'nothing is named',
    )  # fmt: skip
    main = study.comparison.main
    if main is not None:
        yield from build_error_tiles(main)


def _build_calibration_tables(study: Discovery) -> list[TextTable]:
    calibration = study.first.compared
    return [] if calibration is None else [build_first_step_table(calibration)]


def _build_named_tables(study: Discovery) -> Iterator[TextTable | TextSection]:
    """Yield the tables of what is missing, or may be, and what its effects are."""
    heads = ('missing', 'value', '95 % interval', 'vehicle file', 'evidence', 'or instead')
    note = (
        'Evidence: by how many nats the flights are less probable without it; one nat more is 2.7 '
        'times as probable. What cannot be told apart in these flights is in one row.'
    )
    tables = {
        'What is missing': study.named,
        'What comes closest to the unknown force': study.closest,
    }
    meanings = dict[str, str]()
    for heading, elements in tables.items():
        if not elements:
            continue
        yield TextTable(heading, heads, [row for one in elements for row in _list_rows(one)], note)
        for name in (name for one in elements for name in one.present.names):
            effect = name.partition('.')[0]
            if text := explain_effect(effect):
                meanings[effect] = f'*{effect.replace("_", " ")}*: {text}'
    if meanings:
        yield TextSection('These effects', list(meanings.values()), bullets=True, marked=True)


def _list_rows(one: NamedElement) -> Iterator[list[str]]:
    """Yield the rows of an element: one for each of its numbers."""
    evidence = f'{format_number(one.present.gain)} nats'
    others = join_words([format_names(name) for name in one.alternatives], 'or')
    if one.present.kind == 'force':
        yield [f'force: {one.present.names[0]}', '', '', '', evidence, others]
    assumed = [f'{format_parameter(key)} {format_number(value)} assumed'
               for key, value in one.assumed.items()]  # fmt: skip
    for each in one.estimates:
        unit, factor = SHOWN_UNITS.get(each.unit, (each.unit, 1.0))
        low, high = (factor * end for end in each.ci95)
        now, *ends = format_with_interval(factor * each.value, (low, high))
        before = append_unit(format_number(factor * each.before), unit)
        yield [
            '; '.join([format_parameter(each.name), *assumed]),
            append_unit(now, unit),
            ' to '.join(ends),
            before if each.in_file else 'none',
            evidence,
            others,
        ]


def _build_forecast_blocks(study: Discovery) -> list[Picture | TextTable]:
    """Return figure and tables of the forecast errors; nothing if no flight is long enough."""
    scores = study.comparison.scores
    if not scores:
        return []
    where = 'held-out flights' if study.held_out else 'flights that the search has seen'
    remark = f'The flights are {where}.'
    for name, what in ((NAMED, 'is named'), (CLOSEST, 'comes closest')):
        if name in study.comparison.forecasts:
            ratio = format_ratio(study.comparison.compare(name, TUNED))
            remark += f' What {what} multiplies the error of fitted tolerances by {ratio}.'
    return [
        draw_errors(scores, where),
        *build_error_tables({'': scores}, remark),
    ]


def _build_details(study: Discovery) -> Iterator[TextTable]:
    """Yield what else was considered, what remains unexplained, and the noise."""
    missing = study.missing
    shares = [
        [format_names(name), f'{100.0 * share:.0f} %']
        for name, share in missing.probabilities.items()
        if share >= LEAST_PROBABILITY
    ]
    note = (
        'Probability among the models that the search looked at. Named is what has 95 %, and '
        'what fits with and without it confirm.'
    )
    yield TextTable('Candidates', ('element', 'probability'), shares, note, printed=False)
    floor = wrench_floor(study.nominal)
    pair = [average_noise(each).wrench for each in (missing.bare.noise, missing.found.noise)]
    rows = [
        [axis, *(f'{format_number(1e3 * one[k])} {"mN" if k < 3 else "mN m"}' for one in pair),
         f'{pair[1][k] / floor[k]:.1f}']
        for k, axis in enumerate(AXES)
    ]  # fmt: skip
    heads = ('axis', 'tolerances fitted', 'with what is named', 'by the noise floor')
    yield TextTable('Unexplained force and moment, RMS', heads, rows, printed=False)


def _encode(
    study: Discovery,
    conclusion: Conclusion,
    name: str,
    cuts: Sequence[ExcludedInterval],
    warnings: Sequence[str],
) -> dict[str, Any]:
    """Return the content of discovery.json, in SI units."""
    missing = study.missing
    calibration = study.first.compared
    return {
        'schema': REPORT_SCHEMA,
        'vehicle': name,
        'verdict': conclusion.verdict,
        'conclusion': {
            'headline': conclusion.headline,
            'details': conclusion.details,
            'advice': conclusion.advice,
            'writes_file': conclusion.writes_file,
        },
        'effects': [_encode_element(one) for one in study.named if one.estimates],
        'forces': [
            {'name': one.present.names[0], 'log_evidence': one.present.gain}
            for one in study.named
            if not one.estimates
        ],
        'closest': [_encode_element(one) for one in study.closest],
        'corrections': encode_corrections(study.corrections),
        'probabilities': missing.probabilities,
        'trust': missing.trust,
        'unexplained': {
            key: dict(zip(AXES, average_noise(each).wrench.tolist(), strict=True))
            for key, each in (('before', missing.bare.noise), ('after', missing.found.noise))
        },
        'held_out': study.held_out,
        'gaps': [gap for one in study.comparison.scores for gap in _encode_score(one)],
        'bags': {
            role: [title for title, (own, _) in study.flights.items() if own == role]
            for role in ROLES
        },
        'seconds': {title: GRID_PERIOD * float(one.usable.sum())
                    for title, (_, one) in study.flights.items()},
        'left_out': [
            {'flight': cut.flight, 'channel': cut.channel, 'from_s': cut.from_s, 'to_s': cut.to_s,
             'reason': cut.reason}
            for cut in cuts
        ],
        'calibration': calibration and encode_calibration(calibration),
        'warnings': warnings,
    }  # fmt: skip


def _encode_element(one: NamedElement) -> dict[str, Any]:
    """Return an effect, or a number of the vehicle, with its values."""
    return {
        'name': one.present.names[0].partition('.')[0],
        'knobs': [each.name for each in one.estimates],
        'parameters': {
            each.name.partition('.')[2]: {
                'value': each.value,
                'unit': each.unit,
                'ci95': each.ci95,
                'before': each.before if each.in_file else None,
            }
            for each in one.estimates
        },
        'probability': one.present.probability,
        'log_evidence': one.present.gain,
        'confusable_with': one.alternatives,
        'assumed': one.assumed,
    }


def _encode_score(one: HorizonErrors) -> list[dict[str, Any]]:
    """Return the errors of position and attitude at a horizon, by the model."""
    after = next(name for name in (NAMED, CLOSEST, TUNED) if name in one.errors)
    models = {
        'before': FILE_MODEL,
        'calibrated': CALIBRATED_FILE,
        'tuned': TUNED,
        'after': after,
        'written': WRITTEN,
        'coast': COASTING,
    }
    return [
        {
            'channel': channel,
            'unit': unit,
            'horizon_s': one.horizon,
            **{key: getattr(one.errors[model], channel) for key, model in models.items()
               if model in one.errors},
            'perfect': getattr(one.least, channel),
            'pieces': one.forecasts,
        }
        for channel, unit in (('position', 'm'), ('attitude', 'rad'))
    ]  # fmt: skip
