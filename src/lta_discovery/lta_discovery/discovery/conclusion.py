# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Draw the conclusion of a study: the single source of its headline, advice and files.

The search says what is present; forecasts decide whether its names are asserted and whether the
corrected file is advised. Page, terminal, JSON and vehicle file follow from this module.
"""

from dataclasses import dataclass
from typing import Final, final, Literal

from lta_discovery.calibration.calibrated_file import CALIBRATED_FILE
from lta_discovery.calibration.result import JudgedCorrection
from lta_discovery.calibration.verdict import format_values, list_differences
from lta_discovery.discovery.study import (
    CLOSEST,
    Discovery,
    NAMED,
    NamedElement,
    ParameterEstimate,
    TUNED,
    WRITTEN,
)
from lta_discovery.formatting import (
    append_unit,
    format_error,
    format_number,
    format_parameter,
    format_with_interval,
    join_words,
    SHOWN_UNITS,
)
from lta_discovery.model.candidates import vector_components
from lta_discovery.settings import UNEXPLAINED, WORSE
from lta_discovery.state_filter.forecast_scores import COASTING, FILE_MODEL, HorizonErrors
from lta_discovery.state_filter.noise_model import average_noise, wrench_floor
from lta_model.effects.protocol import AXES
import numpy as np

# Without a name, by the better file
CONCLUSION_ADVICE: Final = {
    FILE_MODEL: 'Keep the vehicle file.',
    CALIBRATED_FILE: 'Use the calibrated vehicle file, calibrated.yaml in the results folder.',
}
USE_CORRECTED: Final = 'Use the corrected vehicle file, vehicle.yaml in the results folder.'
Verdict = Literal['none', 'named', 'unexplained', 'named+unexplained', 'not_identifiable']


@final
@dataclass(frozen=True, slots=True)
class Conclusion:
    """What the flights support, in words."""

    verdict: Verdict
    headline: str
    details: tuple[str, ...]  # sentences that follow
    advice: str  # what to do with the vehicle file
    writes_file: bool  # whether the file with what is named is written
    writes_calibrated: bool  # whether the calibrated file is written


def draw_conclusion(study: Discovery) -> Conclusion:
    """Return the conclusion of a study."""
    numbers = [one for one in study.named if one.present.kind != 'force']
    forces = [one for one in study.named if one.present.kind == 'force']
    main = study.comparison.main
    rest = _format_unexplained(study, forces)
    base = _choose_base(study, main)
    calibrated = _format_calibration(study, base)
    if main is not None and _is_beaten_by_coasting(main):
        return Conclusion(
            'not_identifiable', _format_inconclusive(main, numbers), calibrated,
            'Record flights that move more, with all commands used, before you change the file.',
            writes_file=False, writes_calibrated=False,
        )  # fmt: skip
    if not numbers:
        more = ' more' if calibrated else ''
        headline, *details = (
            *calibrated,
            rest or f'These flights show nothing{more} that the vehicle file lacks.',
        )
        is_closer = (
            bool(study.closest)
            and main is not None
            and main.errors[WRITTEN].position < main.errors[base].position
        )
        return Conclusion(
            'unexplained' if rest else 'none',
            headline,
            (*details, *_format_closest(study), *_format_tuning(main)),
            USE_CORRECTED if is_closer else CONCLUSION_ADVICE[base],
            writes_file=is_closer,
            writes_calibrated=base == CALIBRATED_FILE,
        )
    names = join_words([format_element(one) for one in numbers])
    verb = 'lacks' if any(one.present.kind == 'effect' for one in numbers) else 'has wrong'
    is_better = main is None or main.errors[WRITTEN].position < WORSE * main.errors[base].position
    doubt = next((one.present.names for one in numbers if one.alternatives), ())
    advice = (
        USE_CORRECTED
        if is_better
        else f'{CONCLUSION_ADVICE[base]} With what is named it forecasts these flights worse.'
    )
    if is_better and doubt:
        advice += (
            ' These flights do not show which of the alternatives is right; lta tests between '
            f'{doubt[0]} {doubt[1]} with the same --vehicle looks for a test that does.'
        )
    return Conclusion(
        'named+unexplained' if rest else 'named',
        f'The vehicle file {verb} {names}.',
        tuple(filter(None, (
            _format_gain(study, main), rest, *calibrated,
        ))),
        advice,
        writes_file=is_better,
        writes_calibrated=base == CALIBRATED_FILE,
    )  # fmt: skip


def _choose_base(study: Discovery, main: HorizonErrors | None) -> str:
    """Return the file without names that forecasts better: the vehicle file or the calibrated."""
    if study.first.calibration is not None:
        return CALIBRATED_FILE
    if main is None or CALIBRATED_FILE not in main.errors:
        return FILE_MODEL
    return min((FILE_MODEL, CALIBRATED_FILE), key=lambda name: main.errors[name].position)


def _is_beaten_by_coasting(main: HorizonErrors) -> bool:
    """Return whether constant velocity forecasts positions better than every model."""
    models = [one.position for name, one in main.errors.items() if name != COASTING]
    return main.errors[COASTING].position <= min(models)


def _format_inconclusive(main: HorizonErrors, numbers: list[NamedElement]) -> str:
    names = join_words([format_element(one) for one in numbers])
    may = f' {names} may be missing, but' if names else ''
    return (
        f'These flights are inconclusive:{may} {main.horizon:g} s ahead, coasting forecasts the '
        f'position best, to {format_error(main.errors[COASTING].position)}.'
    )


def format_element(one: NamedElement) -> str:
    """Return an element with its value and its alternatives: 'net lift 3.1 mN or ballast'."""
    parts = [f'{format_parameter(each.name)} {_format_value(each)}' for each in one.estimates]
    if one.present.kind == 'force':
        return one.present.names[0]
    return join_words([join_words(parts), *map(format_names, one.alternatives)], 'or')


def format_names(name: str) -> str:
    """Return an element in words, with all components of a vector."""
    return join_words([format_parameter(part) for part in vector_components(name)])


def _format_value(one: ParameterEstimate) -> str:
    unit, factor = SHOWN_UNITS.get(one.unit, (one.unit, 1.0))
    ends = (factor * one.ci95[0], factor * one.ci95[1])
    return append_unit(format_with_interval(factor * one.value, ends)[0], unit)


def _format_unexplained(study: Discovery, forces: list[NamedElement]) -> str:
    """Return what no effect of the library explains, in a sentence; '' if nothing."""
    if forces:
        names = join_words([one.present.names[0] for one in forces])
        return f'A force acts that no effect of the library describes: {names}.'
    ratio = average_noise(study.missing.found.noise).wrench / wrench_floor(study.nominal)
    k = int(np.argmax(ratio))
    if ratio[k] < UNEXPLAINED:
        return ''
    size = average_noise(study.missing.found.noise).wrench[k]
    unit = 'mN' if k < 3 else 'mN m'
    kind = 'force' if k < 3 else 'moment'
    return (
        f'A {kind} in {AXES[k]} of {format_number(1e3 * size, 2)} {unit} (RMS) acts that follows '
        'nothing that was measured.'
    )


def _format_gain(study: Discovery, main: HorizonErrors | None) -> str:
    """Return what the names are worth in forecasts; '' if no flight is long enough."""
    if main is None:
        return ''
    where = 'held-out flights' if study.held_out else 'the same flights'
    return _format_errors(main, f' on {where}', [TUNED, NAMED])


def _format_tuning(main: HorizonErrors | None) -> list[str]:
    """Return what fitting the tolerances gains, and what comes closest to an unknown force."""
    return [] if main is None else [_format_errors(main, '', [TUNED, CLOSEST])]


def _format_errors(main: HorizonErrors, where: str, names: list[str]) -> str:
    """Return the position errors of the file, the calibrated one and other models."""
    sizes = {name: format_error(one.position) for name, one in main.errors.items()}
    words = {
        FILE_MODEL: 'with the vehicle file',
        CALIBRATED_FILE: 'with calibrated.yaml',
        TUNED: 'with fitted tolerances',
        NAMED: 'with what is named as well',
        CLOSEST: 'with what comes closest as well',
    }
    parts = [
        f'{sizes[name]} {words[name]}'
        for name in (FILE_MODEL, CALIBRATED_FILE, *names)
        if name in sizes
    ]
    return f'Position error {main.horizon:g} s ahead{where}: {", ".join(parts)}.'


def _format_calibration(study: Discovery, base: str) -> tuple[str, ...]:
    """Return what the calibration found, if the calibrated file is the better one."""
    calibration = study.first.compared
    if calibration is None or base == FILE_MODEL:
        return ()
    differences = '; '.join(list_differences(calibration)) or 'several numbers by little'
    return (
        f'The vehicle file is off, and was calibrated: {differences}.',
        *(_format_correction(one, study) for one in study.corrections if one.is_confirmed),
    )


def _format_correction(one: JudgedCorrection, study: Discovery) -> str:
    """Return a correction that forecasts confirm, with its values."""
    main = study.comparison.main
    ahead = '' if main is None else f' {main.horizon:g} s ahead'
    where = 'held-out flights' if study.held_out else 'the same flights'
    losses = [100.0 / each - 100.0 for each in (one.ratio.value, *reversed(one.ratio.ci95))]
    loss, low, high = (format_number(each, 2) for each in losses)
    return (
        f'Forecasts of {where} confirm {join_words(format_values(one.correction))}: without, the '
        f'position error is {loss} % ({low} to {high}) larger{ahead}.'
    )


def _format_closest(study: Discovery) -> tuple[str, ...]:
    """Return which effects and numbers come closest to an unknown force."""
    if not study.closest:
        return ()
    names = join_words([format_element(one) for one in study.closest])
    verb = 'comes' if len(study.closest) == 1 else 'come'
    return (f'Of the library, {names} {verb} closest.',)
