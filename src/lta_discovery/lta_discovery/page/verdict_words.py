"""What a study concludes, in sentences: the headline, what to do, the figures on the tiles."""

from pathlib import Path
from typing import Final

from lta_config.typed import near, typed
from lta_discovery.conclusion import ADVICE, Conclusion, draw_conclusion, main_gap
from lta_discovery.finding import Finding, NamedEffect
from lta_discovery.outside.draught import Draught
from lta_discovery.page.words import (
    amount,
    because,
    called,
    figure,
    format_assumed,
    learned_words,
    listed,
    MANY,
    odds,
    percent,
    remainder_words,
    spoken,
)
from lta_report.formatting import MISSING, Tile

ROLES: Final = {
    'train': 'learned from', 'confirm': 'confirmed by', 'holdout': 'shown on',
}  # fmt: skip


def headline(found: Finding) -> str:
    """Return the verdict in a sentence."""
    said, rest = draw_conclusion(found), _rest(found)
    if found.verdict == 'none':
        return f'{_none(said)}{_air(found)}'
    if found.verdict == 'not_identifiable':
        return _cannot_tell(found, said)
    if found.verdict == 'unexplained':
        return f'Something is missing that is in no library{rest}.'
    names = listed([_or_its_rivals(one) for one in found.effects])
    verb = 'are' if _many(found) else 'is'
    text = f'{names[:1].upper()}{names[1:]} {verb} missing{_better(found, said)}'
    if found.verdict == 'named+unexplained':
        return f'{text}; and something that is in no library{rest}.'
    return f'{text}.'


def _cannot_tell(found: Finding, said: Conclusion) -> str:
    """Return what flights cannot tell."""
    if said.coasting:
        return 'These flights cannot tell: ignoring the commands predicts better than the model.'
    if not found.effects:
        return 'These flights cannot tell what, if anything, is missing.'
    names = listed([called(one) for one in found.effects])
    if not said.rivals:
        return f'It may be {names} that is missing, but these flights cannot tell.'
    rivals = listed([spoken(knob) for knob in said.rivals], 'or')
    return f'These flights cannot tell {names} from {rivals}.'


def _many(found: Finding) -> bool:
    """Tell whether more than one thing was named."""
    return sum(len(one.knobs) for one in found.effects) > 1


def _or_its_rivals(one: NamedEffect) -> str:
    """Return what an effect is called, with what these flights cannot tell from it."""
    return listed([called(one), *map(spoken, one.confusable_with)], 'or')


def _rest(found: Finding) -> str:
    """Return the largest thing that is unexplained, to be put behind 'in no library'."""
    if found.remains:
        return f': {remainder_words(found.remains[0])}'
    return f': {found.unexplained[0]}' if found.unexplained else ''


def _air(found: Finding) -> str:
    """Return that a draught was there, as a sentence to be put behind another."""
    return f' A draught of {draught_size(found.draught)} was there.' if found.draught else ''


def draught_size(one: Draught) -> str:
    """Return how hard a draught pushes."""
    return f'{figure(1e3 * one.force, 2)} mN'


def _none(said: Conclusion) -> str:
    """Return that nothing is missing; and that the file is off nevertheless, where it is."""
    gap = said.gain
    if gap is None:
        if said.advice == 'keep':
            return 'Nothing is missing that these flights could show.'
        return 'No effect is confirmed as missing.'
    before, tuned = (amount(part, gap.unit, 2) for part in (gap.before, gap.tuned))
    return (
        f'No effect is confirmed as missing: tuning the tolerances of the file takes the '
        f'{gap.channel} error after {gap.horizon_s:g} s from {before} to {tuned}.'
    )


def _better(found: Finding, said: Conclusion) -> str:
    """Return by how much the named effects shrink the gap, to be put behind what is missing."""
    gap = said.gain
    if gap is None:
        return ''
    them = 'them' if _many(found) else 'it'
    if said.rivals:
        them = listed([called(one) for one in found.effects])
    text = (
        f': with {them}, the {gap.channel} error after {gap.horizon_s:g} s falls from '
        f'{amount(gap.before, gap.unit, 2)} to {amount(gap.after, gap.unit, 2)}'
    )
    return f'{text}, as it does with tolerances alone' if said.by_tolerances else text


def format_advice(found: Finding) -> str:
    """Return what to do with the vehicle file, in a sentence or two."""
    said = draw_conclusion(found)
    which = ' Which of the names is right, it does not tell.' if said.rivals else ''
    return ADVICE[said.advice] + (which if said.advice == 'use' else '')


def learned_commands(found: Finding, folder: Path) -> dict[str, str]:
    """Return what to type to see what was learned, and to fly it where that is the advice."""
    if not found.effects:
        return {}
    learned = near(folder / 'vehicle.yaml')
    out = {'see what was learned': typed('vehicle', 'diff', found.vehicle, learned)}
    if draw_conclusion(found).advice == 'use':
        out['fly it'] = typed('fly', '--vehicle', learned)
    return out


def about(found: Finding) -> str:
    """Return which flights there were, and for what."""
    parts = [f'{words} {listed(found.bags[role])}' for role, words in ROLES.items()
             if found.bags.get(role)]  # fmt: skip
    said = ', '.join(parts) or found.vehicle
    shown = (
        'Nothing was fitted to the flights on which the gap is shown.'
        if found.held_out
        else 'No flight was held out: the gap is shown on flights that had a say, which is weaker.'
    )
    count = len(found.warnings)
    more = f' {count} {"warning" if count == 1 else "warnings"} below.' if count else ''
    return f'{said[:1].upper()}{said[1:]}. {shown if found.gaps else ""}{more}'.strip()


def tiles(found: Finding) -> list[Tile]:
    """Return the figures that matter most: what, how sure, how much better, what is left."""
    gap = main_gap(found.gaps)
    made = [_verdict_tile(found), _evidence_tile(found)]
    if gap is None:
        made.append(Tile('Error', MISSING, '', 'no flight to show it on'))
    else:
        ahead = f'{gap.channel.capitalize()} error after {gap.horizon_s:g} s'
        value, _, unit = amount(gap.after, gap.unit).partition(' ')
        before, tuned = (amount(part, gap.unit) for part in (gap.before, gap.tuned))
        low, high = (percent(part) for part in gap.shrink_ci95)
        floor, coast = (amount(part, gap.unit) for part in (gap.noise_floor, gap.coast))
        made += [
            Tile(ahead, value, unit, f'before {before}; tuned without any effect {tuned}'),
            Tile('The gap shrinks by', percent(gap.shrink), '%',
                 f'{low} to {high} % (95 %), {gap.pieces} pieces'),
            Tile('Noise of the measurement', *floor.partition(' ')[::2],
                 f'ignoring the commands: {coast}'),
        ]  # fmt: skip
    made.append(_rest_tile(found))
    return made


def _rest_tile(found: Finding) -> Tile:
    """Return what is unexplained."""
    if found.remains:
        first = found.remains[0]
        return Tile(
            'Unexplained', figure(first.floors, 2), '\N{MULTIPLICATION SIGN} the floor',
            f'on {listed([one.axis for one in found.remains])}',
        )  # fmt: skip
    if found.unexplained:
        return Tile('Unexplained', str(len(found.unexplained)), '', found.unexplained[0])
    left = (
        f'a draught of {draught_size(found.draught)}, and no other force or moment'
        if found.draught
        else 'no force or moment is left over'
    )
    return Tile('Unexplained', '0', 'axes', left)


def _verdict_tile(found: Finding) -> Tile:
    """Return the verdict as a tile."""
    count = sum(1 if len(one.knobs) > MANY else len(one.knobs) for one in found.effects)
    values = [
        f'{spoken(f"{one.name}.{part.name}")} {learned_words(part)}{format_assumed(one)}'
        for one in found.effects
        for part in one.parameters
    ]
    note = {
        'none': 'every candidate was tried',
        'unexplained': 'and no effect of the library fits',
        'not_identifiable': 'another flight would have to',
    }.get(found.verdict, '; '.join(values[:3]))
    value = {'none': 'none', 'unexplained': 'no name', 'not_identifiable': 'cannot tell'}
    return Tile('Missing', value.get(found.verdict, str(count)),
                '' if found.verdict in value else 'named', note)  # fmt: skip


def _evidence_tile(found: Finding) -> Tile:
    """Return how sure it is."""
    if found.effects:
        least = min(one.log_evidence for one in found.effects)
        which = 'the weaker of them; ' if len(found.effects) > 1 else ''
        against = '; none against what it may be instead' if draw_conclusion(found).rivals else ''
        return Tile('Evidence', figure(least), 'nats', f'{which}{odds(least)}{against}')
    tried = [rung for step in found.ladder for rung in step]
    if not tried:
        return Tile('Evidence', MISSING, '', 'no candidate was worth a refit')
    best = max(tried, key=lambda rung: rung.total)
    return Tile(
        'Best candidate', figure(best.total), 'nats',
        f'{spoken(best.knob)}: {because(best, beaten=False, stands=False)}',
    )  # fmt: skip
