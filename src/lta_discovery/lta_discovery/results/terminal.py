"""Print the result of a study to the terminal."""

from collections.abc import Iterator
import math
from typing import Final

from lta_discovery.calibration.report import build_first_step_table
from lta_discovery.calibration.verdict import format_forecast_sentence
from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import ChannelErrors, StudyResult, TransferEvidence
from lta_discovery.forecast.flight_prediction import NAMES
from lta_discovery.page.formatting import (
    append_unit,
    format_assumed,
    format_file_value,
    format_number,
    format_percent,
    format_quantity,
    format_with_interval,
    join_words,
)
from lta_discovery.page.law_section import list_law_sentences
from lta_discovery.page.verdict_text import format_advice, format_details, format_headline
from lta_discovery.results.discovery_json import common_horizon
from lta_model.effects.protocol import AXES
from lta_report.report import TextTable
from lta_report.report_terminal import print_table
from rich.console import Console
from rich.text import Text

BAR: Final = 32  # characters
BARS: Final = (
    ('coast', 'ignoring the commands', 'dim'),
    ('before', 'the vehicle file', 'red'),
    ('tuned', 'its tolerances fitted', 'yellow'),
    ('after', 'with the {} effects', 'green'),
    ('refitted', 'all numbers refitted', 'cyan'),
    ('noise_floor', 'measurement noise', 'dim'),
)
WHOLE: Final = ('position', 'attitude')
MOST: Final = 8  # most discrepancies that are printed


def print_finding(finding: StudyResult, console: Console) -> None:
    """Print verdict, effects with intervals, prediction errors and discrepancies."""
    console.print(Text(format_headline(finding), 'bold'), soft_wrap=True)
    if details := format_details(finding):
        console.print(Text(details), soft_wrap=True)
    if finding.calibration is not None:
        print_table(build_first_step_table(finding.calibration), console)
        console.print(Text(format_forecast_sentence(finding.calibration)), soft_wrap=True)
    for effect_line in format_effects(finding):
        console.print(Text(effect_line), soft_wrap=True)
    if finding.carried is not None:
        effect_line = format_forecast_evidence(finding.carried, bool(finding.effects))
        console.print(Text(effect_line), soft_wrap=True)
    for line in format_prediction_errors(finding):
        console.print(line, soft_wrap=True)
    if finding.where:
        print_table(build_discrepancy_table(finding), console)
    for effect_line in finding.unexplained:
        console.print(Text(f'Unexplained: {effect_line}.'), soft_wrap=True)
    for effect_line in list_law_sentences(finding):
        console.print(Text(effect_line), soft_wrap=True)
    if finding.draught is not None:
        effect_line = finding.draught.sentence
        console.print(Text(f'{effect_line[:1].upper()}{effect_line[1:]}.'), soft_wrap=True)
    console.print(Text(f'{format_advice(finding)} {finding.next_flight}'.strip()), soft_wrap=True)
    for word in finding.warnings:
        console.print(Text(word, 'yellow'), soft_wrap=True)


def format_named_parameters(finding: StudyResult) -> str:
    """Return the parameters in one line, as the demonstration words its hidden effect."""
    names = join_words(
        [
            f'{effect.name}.{one.name} = {append_unit(format_number(one.value), one.unit)}'
            for effect in finding.effects
            for one in effect.parameters
        ]
        or ['nothing']
    )
    status = draw_conclusion(finding).effect_status
    return names if status == 'named' else f'{names} (possible, not named)'


def format_forecast_evidence(carried: TransferEvidence, named: bool = False) -> str:
    """Return the forecast evidence in a sentence; `named`: whether readings named effects."""
    ratios = [one.ratio for one in carried.regimes]
    better = sum(ratio < 1.0 for ratio in ratios)
    all_fitted = f'ith all {carried.numbers} candidate parameters fitted to forecasts'
    what = 'The effects were identified by forecasts'
    if not carried.names:
        what = f'W{all_fitted}' if named else f'Forecasts identify no effect; w{all_fitted}'
    return (
        f'{what}: {better} of {len(ratios)} flight regimes, '
        f'each left out of the fit, are predicted better than by the vehicle file (error ratio '
        f'{min(ratios):.2f} to {max(ratios):.2f}).'
    )


def format_effects(finding: StudyResult) -> Iterator[str]:
    """Yield the named effects and their parameters, one line each."""
    for one in finding.effects:
        rivals = join_words(one.confusable_with, 'or')
        instead = f'; it may be {rivals} instead' if rivals else ''
        yield f'{one.name}: evidence {format_number(one.log_evidence)} nats{instead}'
        for each in one.parameters:
            now, low, high = format_with_interval(each.value, each.ci95)
            yield (
                f'  {each.name} {append_unit(now, each.unit)} '
                f'(95 %: {low} to {high}; {format_file_value(each)})'
            )
        if one.assumed:
            yield f'  These values are valid{format_assumed(one)}.'


def format_prediction_errors(finding: StudyResult) -> Iterator[Text]:
    """Yield headings and bars of the prediction errors of all models."""
    gaps = finding.gaps or finding.training
    file = 'the vehicle file' if finding.calibration is None else 'the calibrated file'
    at = common_horizon(gaps)
    for one in gaps:
        if one.horizon_s == at and one.channel in WHOLE:
            held_out = finding.held_out and finding.gaps
            seen = 'on held-out flights' if held_out else 'on flights used in the search'
            sign, word = (1.0, 'less') if one.shrink >= 0.0 else (-1.0, 'more')
            low, high = (
                format_percent(part) for part in sorted(sign * end for end in one.shrink_ci95)
            )
            yield Text(
                f'{one.channel.capitalize()} error after {at:g} s, {seen}: '
                f'{format_percent(sign * one.shrink)} % '
                f'{word} than with {file} (95 % interval {low} to {high} %)'
            )
            yield from _format_bars(one, finding, file)


def _format_bars(one: ChannelErrors, finding: StudyResult, file: str) -> Iterator[Text]:
    """Yield a bar for each model."""
    # The model that ignores the commands may be far off; its bar is cut at the others' scale.
    most = max(one.before, one.tuned, one.after, 1e-12)
    status = draw_conclusion(finding).effect_status
    for key, label, style in BARS:
        size = getattr(one, key)
        absent = key == 'after' and not finding.effects
        if absent or (key == 'refitted' and not math.isfinite(size)):
            continue
        label = file if key == 'before' else label.format(status)
        share = min(size / most, 1.0) if math.isfinite(size) else 0.0
        bar = '█' * round(BAR * share) + ('>' if size > most else '')
        yield Text(f'  {label:22}{format_quantity(size, one.unit):>9}  ').append(bar, style)


def build_discrepancy_table(finding: StudyResult) -> TextTable:
    """Return the table of the largest discrepancies."""
    forces = [place for place in finding.where if place.channel in AXES]
    others = [place for place in finding.where if place.channel not in AXES]
    lines = [
        [
            NAMES.get(place.channel, place.channel), place.flight, f'{place.from_s:.0f} s',
            f'{place.to_s:.0f} s', place.condition, f'{place.ratio_to_noise:.1f}',
        ]
        for place in [*forces, *others][:MOST]
    ]  # fmt: skip
    heads = ('where', 'flight', 'from', 'to', 'when', 'error/noise')
    return TextTable('Largest deviations from the model', heads, lines)
