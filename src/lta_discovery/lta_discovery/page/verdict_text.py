"""Word the conclusion of a study: headline, advice, summary tiles."""

from pathlib import Path
from typing import Final

from lta_config.command_line import format_lta_command, relative_path
from lta_discovery.calibration.verdict import list_differences
from lta_discovery.conclusion import (
    ADVICE,
    Conclusion,
    draw_conclusion,
    FAR,
    select_main_error,
)
from lta_discovery.finding import ChannelErrors, NamedEffect, StudyResult
from lta_discovery.page.formatting import (
    explain_decision,
    format_assumed,
    format_effect,
    format_estimate,
    format_number,
    format_odds,
    format_parameter,
    format_percent,
    format_quantity,
    format_remainder,
    join_words,
    MANY,
)
from lta_discovery.unmodeled.draught import DraughtEstimate
from lta_report.formatting import format_count, MISSING, Tile

MOST: Final = 3  # most calibration offsets in the headline
LONGEST: Final = 2  # sentences of the headline
# Advice after a calibration, where it differs from `ADVICE`
CALIBRATED: Final = {
    'keep': 'Use the calibrated vehicle file: calibrated.yaml in the results folder.',
    'measure': 'Use the calibrated vehicle file: calibrated.yaml in the results folder. Measure '
    'its other parameters again.',
    'again': 'Use the calibrated vehicle file, calibrated.yaml in the results folder, and record '
    'another flight before you add an effect to it.',
}
COMPENSATE: Final = 'Its numbers compensate each other and are no findings.'
ROLES: Final = {
    'train': 'learned from', 'confirm': 'confirmed by', 'holdout': 'tested on',
}  # fmt: skip


def format_headline(finding: StudyResult) -> str:
    """Return the verdict in at most two sentences."""
    return ' '.join(_list_sentences(finding)[:LONGEST])


def format_details(finding: StudyResult) -> str:
    """Return the sentences that follow the headline; '' if there are none."""
    return ' '.join(_list_sentences(finding)[LONGEST:])


def _list_sentences(finding: StudyResult) -> list[str]:
    """Return the verdict in sentences, the most important ones first."""
    conclusion = draw_conclusion(finding)
    verdict, *more = _list_verdict(finding, conclusion)
    first, useless = _format_first_step(finding, conclusion), _format_useless(conclusion)
    refit = _format_refit_gain(finding, conclusion.refitted)
    if not refit:
        sentences = [first, verdict, useless, *more]
    elif finding.calibration is None:
        sentences = [verdict, refit, first, *more]
    elif finding.effects:
        sentences = [first, verdict, refit, *more]
    else:
        sentences = [first, refit, verdict, *more]
    return [one for one in sentences if one]


def _format_first_step(finding: StudyResult, conclusion: Conclusion) -> str:
    """Return what was calibrated or should be, in a sentence; '' if nothing."""
    if finding.calibration is not None:
        return f'Calibrated first ({"; ".join(list_differences(finding.calibration)[:MOST])}).'
    if not finding.offsets:
        return ''
    start = 'Calibrate first' if conclusion.refitted is None else 'The vehicle file is off'
    return f'{start} ({"; ".join(finding.offsets[:MOST])}).'


def _format_refit_gain(finding: StudyResult, gap: ChannelErrors | None) -> str:
    """Return a sentence on the refitted file if it forecasts best; else ''."""
    if gap is None:
        return ''
    coast, before, refitted = (
        format_quantity(part, gap.unit, 2) for part in (gap.coast, gap.before, gap.refitted)
    )
    file = 'vehicle file' if finding.calibration is None else 'calibrated file'
    return (
        f'With all numbers refitted, the {gap.channel} error after {gap.horizon_s:g} s is '
        f'{refitted} ({file} {before}, coasting {coast}).'
    )


def _format_useless(conclusion: Conclusion) -> str:
    """Return a sentence if the final model does not beat coasting; else ''."""
    gap = conclusion.useless
    if gap is None:
        return ''
    coast, after = (format_quantity(part, gap.unit, 2) for part in (gap.coast, gap.after))
    return (
        f'The final model is no improvement: coasting, which ignores the commands, predicts the '
        f'position {gap.horizon_s:g} s ahead as well or better ({coast} against {after}).'
    )


def _list_verdict(finding: StudyResult, conclusion: Conclusion) -> list[str]:
    """Return the verdict in sentences."""
    rest = _format_remainder(finding)
    if finding.verdict == 'none':
        return [*_format_no_effect(conclusion), *_format_draught(finding)]
    if finding.verdict == 'not_identifiable':
        return [_format_unidentifiable(finding, conclusion)]
    if finding.verdict == 'unexplained':
        lacking = f'The model lacks something that no effect of the library describes{rest}.'
        return [lacking, *_format_law(finding)]
    names = join_words([_format_alternatives(one) for one in finding.effects])
    several = _has_several_parameters(finding)
    names = f'{names[:1].upper()}{names[1:]}'
    vain = list[str]()
    if conclusion.idle:
        them = 'them' if several else 'it'
        text = f'{names} may be missing from the model, but no forecast shows {them}.'
        vain = _list_tolerance_gain(conclusion)
    else:
        gain = _format_improvement(finding, conclusion)
        text = f'{names} {"are" if several else "is"} missing from the model{gain}.'
    if finding.verdict == 'named+unexplained':
        more = f'Something else is missing that no effect of the library describes{rest}.'
        return [text, more, *_format_law(finding), *vain]
    return [text, *vain]


def _format_unidentifiable(finding: StudyResult, conclusion: Conclusion) -> str:
    """Return the headline of a study that does not identify an effect."""
    if conclusion.coasting:
        return (
            'These flights are inconclusive: a forecast that ignores the commands is better than '
            'that of the model.'
        )
    if not finding.effects:
        return 'These flights do not show what, if anything, is missing from the model.'
    names = join_words([format_effect(one) for one in finding.effects])
    if not conclusion.rivals:
        return (
            f'{names[:1].upper()}{names[1:]} may be missing from the model, but these flights are '
            'inconclusive.'
        )
    rivals = join_words([format_parameter(knob) for knob in conclusion.rivals], 'or')
    return f'These flights cannot distinguish {names} from {rivals}.'


def _has_several_parameters(finding: StudyResult) -> bool:
    """Return whether more than one parameter was named."""
    return sum(len(one.knobs) for one in finding.effects) > 1


def _format_alternatives(one: NamedEffect) -> str:
    """Return an effect's name, and those of its rivals."""
    return join_words([format_effect(one), *map(format_parameter, one.confusable_with)], 'or')


def _format_remainder(finding: StudyResult) -> str:
    """Return the largest unexplained force, to be appended to a headline."""
    if finding.remains:
        return f': {format_remainder(finding.remains[0])}'
    return f': {finding.unexplained[0]}' if finding.unexplained else ''


def _format_law(finding: StudyResult) -> list[str]:
    """Return a sentence about the law, if one is proposed."""
    if finding.law is None or finding.law.law is None:
        return []
    count = format_count(len(finding.law.law.terms), 'term')
    far = [one for one in finding.law.errors if one.horizon_s == FAR]
    # The channel that it improves most
    best = min(far, key=lambda one: one.after / one.tuned)
    after, before = (format_quantity(part, best.unit, 2) for part in (best.after, best.tuned))
    return [
        f'A law of {count} describes it: with the law, the {best.channel} error of held-out '
        f'flights after {FAR:g} s is {after}, without {before}.'
    ]


def _format_draught(finding: StudyResult) -> list[str]:
    """Return a sentence about the draught, if there is one."""
    if not finding.draught:
        return []
    return [f'A draught pushed the vehicle with {format_draught_size(finding.draught)} rms.']


def format_draught_size(one: DraughtEstimate) -> str:
    """Return the force of a draught."""
    return f'{format_number(1e3 * one.force, 2)} mN'


def _format_no_effect(conclusion: Conclusion) -> list[str]:
    """Return the verdict if no effect is missing, with the gain of tuned tolerances if any."""
    if conclusion.gain is None and conclusion.advice == 'keep':
        return ['These flights reveal no effect that the model lacks.']
    return ['No missing effect was confirmed.', *_list_tolerance_gain(conclusion)]


def _list_tolerance_gain(conclusion: Conclusion) -> list[str]:
    """Return a sentence on what fitting the tolerances alone gains; nothing if no gain."""
    gap = conclusion.gain
    if gap is None:
        return []
    before, tuned = (format_quantity(part, gap.unit, 2) for part in (gap.before, gap.tuned))
    return [
        f'Fitting the parameters of the vehicle file within their tolerances reduces the '
        f'{gap.channel} error after {gap.horizon_s:g} s from {before} to {tuned}.'
    ]


def _format_improvement(finding: StudyResult, conclusion: Conclusion) -> str:
    """Return how much the named effects reduce the error, to be appended to a headline."""
    gap = conclusion.gain
    if gap is None:
        return ''
    them = 'them' if _has_several_parameters(finding) else 'it'
    if conclusion.rivals:
        them = join_words([format_effect(one) for one in finding.effects])
    before, tuned, after = (
        format_quantity(part, gap.unit, 2) for part in (gap.before, gap.tuned, gap.after)
    )
    text = f': the {gap.channel} error after {gap.horizon_s:g} s falls from {before}'
    # Fitting alone may do most of it, and no effect may take the credit for that
    if gap.tuned < gap.before:
        text += f' to {tuned} by fitting the vehicle file within its tolerances, and'
    return f'{text} to {after} with {them}'


def format_advice(finding: StudyResult) -> str:
    """Return what to do with the vehicle file, in a sentence or two."""
    conclusion = draw_conclusion(finding)
    which = (
        ' These flights do not show which of the alternative effects is right.'
        if conclusion.rivals
        else ''
    )
    if conclusion.advice == 'refitted':
        return f'{ADVICE[conclusion.advice]} {COMPENSATE}{_format_other_flights(finding)}'
    refit = _format_refit(conclusion.refitted)
    if finding.calibration is not None and conclusion.advice in CALIBRATED:
        return CALIBRATED[conclusion.advice] + refit
    return ADVICE[conclusion.advice] + (which if conclusion.advice == 'use' else '') + refit


def _format_refit(gap: ChannelErrors | None) -> str:
    """Return when to use the refitted file, with a space before it; '' if never."""
    if gap is None:
        return ''
    return (
        ' To predict flights in its region of validity, use refitted.yaml: its position error '
        f'after {gap.horizon_s:g} s is {format_quantity(gap.refitted, gap.unit)}. {COMPENSATE}'
    )


def _format_other_flights(finding: StudyResult) -> str:
    """Return what to use outside the region of a refitted file, with a space before it."""
    if finding.calibration is not None:
        return ' For other flights, use calibrated.yaml.'
    return ' For other flights, calibrate the vehicle file first.' if finding.offsets else ''


def list_learned_file_commands(finding: StudyResult, folder: Path) -> dict[str, str]:
    """Return the commands to view the learned file and, if that is the advice, to fly it."""
    conclusion = draw_conclusion(finding)
    if conclusion.advice == 'refitted':
        name, flies = 'refitted.yaml', False
    elif conclusion.advice in ('use', 'law'):
        name, flies = 'vehicle.yaml', True
    elif finding.calibration is not None:
        name, flies = 'calibrated.yaml', True
    elif conclusion.has_learned_file:
        name, flies = 'vehicle.yaml', False
    else:
        return {}
    learned = relative_path(folder / name)
    out = {'show the changes': format_lta_command('vehicle', 'diff', finding.vehicle, learned)}
    if flies:
        out['fly it'] = format_lta_command('fly', '--vehicle', learned)
    return out


def format_flight_roles(finding: StudyResult) -> str:
    """Return the flights with their roles."""
    parts = [f'{words} {join_words(finding.bags[role])}' for role, words in ROLES.items()
             if finding.bags.get(role)]  # fmt: skip
    roles = ', '.join(parts) or finding.vehicle
    errors_note = (
        'The prediction errors are of flights that no fit has used.'
        if finding.held_out
        else 'No flight was held out, so the prediction errors may be too small.'
    )
    count = len(finding.warnings)
    more = f' See the {format_count(count, "warning")} below.' if count else ''
    return f'{roles[:1].upper()}{roles[1:]}. {errors_note if finding.gaps else ""}{more}'.strip()


def build_tiles(finding: StudyResult) -> list[Tile]:
    """Return the key figures: effects, evidence, improvement, remainder."""
    gap = select_main_error(finding.gaps)
    tiles = [_build_verdict_tile(finding), _build_evidence_tile(finding)]
    if gap is None:
        tiles.append(Tile('Prediction error', MISSING, '', 'no flight to compute it on'))
    else:
        refit = draw_conclusion(finding).advice == 'refitted'
        ahead = f'{gap.channel.capitalize()} error after {gap.horizon_s:g} s'
        last = gap.refitted if refit else gap.after
        value, _, unit = format_quantity(last, gap.unit).partition(' ')
        before, tuned = (format_quantity(part, gap.unit) for part in (gap.before, gap.tuned))
        low, high = (format_percent(part) for part in gap.shrink_ci95)
        floor, coast = (format_quantity(part, gap.unit) for part in (gap.noise_floor, gap.coast))
        models = f'with the vehicle file {before}; with its tolerances fitted {tuned}'
        count = f'{gap.pieces} pieces of flight'
        tiles += [
            Tile(ahead, value, unit, f'{"all numbers refitted; " if refit else ""}{models}'),
            Tile('Error reduced by', format_percent(1.0 - gap.refitted / gap.before), '%',
                 f'all numbers refitted; {count}')
            if refit
            else Tile('Error reduced by', format_percent(gap.shrink), '%',
                      f'95 % interval {low} to {high} %; {count}'),
            Tile('Measurement noise', *floor.partition(' ')[::2],
                 f'error of a forecast that ignores the commands: {coast}'),
        ]  # fmt: skip
    tiles.append(_build_remainder_tile(finding))
    return tiles


def _build_remainder_tile(finding: StudyResult) -> Tile:
    """Return the tile of the unexplained forces."""
    if finding.remains:
        first = finding.remains[0]
        return Tile(
            'Unexplained', format_number(first.floors, 2), '\N{MULTIPLICATION SIGN} noise floor',
            f'force or moment on {join_words([one.axis for one in finding.remains])}',
        )  # fmt: skip
    if finding.unexplained:
        return Tile('Unexplained', str(len(finding.unexplained)), '', finding.unexplained[0])
    left = (
        f'a draught of {format_draught_size(finding.draught)}, and no other force or moment'
        if finding.draught
        else 'no unexplained force or moment'
    )
    return Tile('Unexplained', '0', 'axes', left)


def _build_verdict_tile(finding: StudyResult) -> Tile:
    count = sum(1 if len(one.knobs) > MANY else len(one.knobs) for one in finding.effects)
    values = [
        f'{format_parameter(f"{one.name}.{part.name}")} '
        f'{format_estimate(part)}{format_assumed(one)}'
        for one in finding.effects
        for part in one.parameters
    ]
    note = {
        'none': 'every candidate was tried',
        'unexplained': 'no effect of the library fits',
        'not_identifiable': 'another flight is needed',
    }.get(finding.verdict, '; '.join(values[:3]))
    value = {'none': 'none', 'unexplained': 'unknown', 'not_identifiable': 'inconclusive'}
    status = draw_conclusion(finding).effect_status
    return Tile('Missing effects', value.get(finding.verdict, str(count)),
                '' if finding.verdict in value else status, note)  # fmt: skip


def _build_evidence_tile(finding: StudyResult) -> Tile:
    if finding.effects:
        least = min(one.log_evidence for one in finding.effects)
        which = 'the weakest effect; ' if len(finding.effects) > 1 else ''
        against = '; the alternatives fit as well' if draw_conclusion(finding).rivals else ''
        return Tile(
            'Evidence', format_number(least), 'nats', f'{which}{format_odds(least)}{against}'
        )
    tried = [rung for step in finding.ladder for rung in step]
    if not tried:
        return Tile('Evidence', MISSING, '', 'no candidate was promising enough for a full fit')
    best = max(tried, key=lambda rung: rung.total)
    return Tile(
        'Best candidate', format_number(best.total), 'nats',
        f'{format_parameter(best.knob)}: {explain_decision(best, beaten=False)}',
    )  # fmt: skip
