"""What a study says, in sentences: the headline, the figures on the tiles, single numbers."""

from collections.abc import Sequence
import math
from typing import Final

from lta_analysis.discovery.finding import Finding, Gap, Learned, NamedEffect, Rung
from lta_analysis.discovery.forecast.cautions import keeps, WORSE
from lta_analysis.discovery.naming.accept import (
    AGAIN,
    APART,
    GAIN,
    HOLDS,
    LARGER,
    SPOILT,
    TORN,
)
from lta_analysis.discovery.outside.draught import Draught
from lta_analysis.discovery.outside.unexplained import Remainder
from lta_analysis.report.outcome import MISSING, Tile
from lta_sim.effects import EFFECTS
from lta_sim.effects_page import summary

MINUS: Final = '\N{MINUS SIGN}'
DEGREES: Final = 180.0 / math.pi
DEGREE: Final = '\N{DEGREE SIGN}'
SHOWN_UNITS: Final = {'rad': (DEGREE, DEGREES), 'rad/s': (f'{DEGREE}/s', DEGREES)}
RAISED: Final = str.maketrans(
    '0123456789', '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079'
)
LOOSE: Final = 0.7  # of the error before; below it tuning tolerances alone is worth a word
CLOSER: Final = 0.95  # of the error with tolerances alone; above it the effect predicts no better
MANY: Final = 2  # directions of one effect that are not named one by one
FORCES: Final = ('surge', 'sway', 'heave')
ROLES: Final = {
    'train': 'learned from', 'confirm': 'confirmed by', 'holdout': 'shown on',
}  # fmt: skip


def spoken(knob: str) -> str:
    """Return a knob's name as people say it: 'linear drag (surge)', 'net lift'."""
    effect, _, rest = knob.partition('.')
    words, known = effect.replace('_', ' '), EFFECTS.get(effect)
    if not rest or (known is not None and len(known.parameters) == 1):
        return words
    return f'{words} ({rest.replace("_", " ")})'


def called(one: NamedEffect) -> str:
    """Return what an effect is called: by its directions, unless they are many."""
    if len(one.knobs) > MANY:
        return one.name.replace('_', ' ')
    return listed([spoken(knob) for knob in one.knobs])


def meaning(effect: str) -> str:
    """Return what an effect is, in a sentence; '' for one that is not in this registry."""
    known = EFFECTS.get(effect)
    return '' if known is None else f'{summary(known)}.'


def figure(value: float, digits: int = 3) -> str:
    """Return a number in a few digits, without an exponent where that is readable."""
    if not math.isfinite(value):
        return MISSING
    text = f'{value:.{digits}g}'
    if 'e' in text and 1e-5 < abs(value) < 1e6:
        places = max(0, digits - 1 - math.floor(math.log10(abs(value))))
        text = f'{value:.{places}f}'
    return text.replace('-', MINUS)


def within(value: float, interval: tuple[float, float]) -> tuple[str, str, str]:
    """Return a value and its interval, to two digits of the interval's width."""
    width = interval[1] - interval[0]
    if not all(map(math.isfinite, (value, *interval))) or width <= 0.0:
        return figure(value), figure(interval[0]), figure(interval[1])
    places = max(0, 1 - math.floor(math.log10(width)))
    if places > 8:
        return figure(value, 5), figure(interval[0], 5), figure(interval[1], 5)
    a, b, c = (f'{part:.{places}f}'.replace('-', MINUS) for part in (value, *interval))
    return a, b, c


def with_unit(text: str, unit: str) -> str:
    """Return a number with its unit; a pure number stays alone."""
    apart = '' if unit.startswith(DEGREE) else ' '
    return text if unit in ('', '1') else f'{text}{apart}{unit}'


def amount(value: float, unit: str, digits: int = 3) -> str:
    """Return an error as people read it: millimetres, centimetres, degrees."""
    if unit == 'm' and math.isfinite(value):
        size = abs(value)
        scale, name = (1e3, 'mm') if size < 0.01 else (100.0, 'cm') if size < 1.0 else (1.0, 'm')
        return f'{figure(scale * value, digits)} {name}'
    name, factor = SHOWN_UNITS.get(unit, (unit, 1.0))
    return with_unit(figure(factor * value, digits), name)


def percent(share: float) -> str:
    """Return a share in whole per cent."""
    return MISSING if not math.isfinite(share) else f'{100 * share:.0f}'.replace('-', MINUS)


def listed(words: Sequence[str], last: str = 'and') -> str:
    """Return words as a person lists them."""
    if len(words) < 2:
        return ''.join(words)
    return f'{", ".join(words[:-1])} {last} {words[-1]}'


def held(one: Learned) -> str:
    """Return what the vehicle file holds of a parameter: a number, or nothing."""
    return figure(one.before) if one.in_file else MISSING


def held_words(one: Learned) -> str:
    """Return the same as a clause."""
    return f'the file has {figure(one.before)}' if one.in_file else 'the file does not have it'


def learned_words(one: Learned) -> str:
    """Return a parameter with its unit."""
    return with_unit(within(one.value, one.ci95)[0], one.unit)


def remainder_words(one: Remainder) -> str:
    """Return what remains on an axis: 'a force along surge that follows heading (sine)'."""
    kind = f'force along {one.axis}' if one.axis in FORCES else f'{one.axis} moment'
    if not one.follows:
        return f'a {kind} that follows nothing measured'
    return f'a {kind} that follows {listed(one.follows)}'


def size_unit(one: Remainder) -> str:
    """Return the unit of what remains."""
    return 'N' if one.axis in FORCES else 'N m'


def main_gap(gaps: Sequence[Gap]) -> Gap | None:
    """Return the gap that stands for all: of the position, furthest ahead."""
    finite = [gap for gap in gaps if math.isfinite(gap.before) and math.isfinite(gap.after)]
    place = [gap for gap in finite if gap.channel == 'position'] or finite
    return max(place, key=lambda gap: gap.horizon_s, default=None)


def headline(found: Finding) -> str:
    """Return the verdict in a sentence."""
    names = listed([called(one) for one in found.effects])
    many = sum(len(one.knobs) for one in found.effects) > 1
    rest = _rest(found)
    if found.verdict == 'none':
        return f'{_none(found.gaps)}{_air(found)}'
    if found.verdict == 'not_identifiable':
        if coasting(found.gaps):
            return (
                'These flights cannot tell: ignoring the commands predicts better than the model.'
            )
        if not found.effects:
            return 'These flights cannot tell what, if anything, is missing.'
        alike = dict.fromkeys(
            spoken(knob) for one in found.effects for knob in one.confusable_with
        )
        if not alike:
            return f'It may be {names} that is missing, but these flights cannot tell.'
        return f'These flights cannot tell {listed([names, listed(list(alike), "or")], "from")}.'
    if found.verdict == 'unexplained':
        return f'Something is missing that is in no library{rest}.'
    names = listed([_or_its_rivals(one) for one in found.effects])
    said = f'{names[:1].upper()}{names[1:]} {"are" if many else "is"} missing{_better(found)}'
    if found.verdict == 'named+unexplained':
        return f'{said}; and something that is in no library{rest}.'
    return f'{said}.'


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


def _none(gaps: Sequence[Gap]) -> str:
    """Return that nothing is missing; and that the file is off nevertheless, where it is."""
    gap = main_gap(gaps)
    if gap is None or not loose(gap):
        return 'Nothing is missing that these flights could show.'
    before, tuned = (amount(part, gap.unit, 2) for part in (gap.before, gap.tuned))
    return (
        f'No effect is confirmed as missing: tuning the tolerances of the file takes the '
        f'{gap.channel} error after {gap.horizon_s:g} s from {before} to {tuned}.'
    )


def loose(gap: Gap) -> bool:
    """Tell whether numbers of the file within their tolerances make most of the error."""
    return gap.tuned < LOOSE * gap.before


def coasting(gaps: Sequence[Gap]) -> bool:
    """Tell whether a model that ignores the commands predicts the position best."""
    gap = main_gap(gaps)
    return gap is not None and gap.coast < min(gap.tuned, gap.after)


def _better(found: Finding) -> str:
    """Return by how much the named effects shrink the gap, to be put behind what is missing."""
    gap = main_gap(found.gaps)
    if gap is None or gap.shrink <= 0.0 or gap.after > WORSE * gap.tuned or keeps(found.gaps):
        return ''
    them = 'them' if sum(len(one.knobs) for one in found.effects) > 1 else 'it'
    if any(one.confusable_with for one in found.effects):
        them = listed([called(one) for one in found.effects])
    said = (
        f': with {them}, the {gap.channel} error after {gap.horizon_s:g} s falls from '
        f'{amount(gap.before, gap.unit, 2)} to {amount(gap.after, gap.unit, 2)}'
    )
    return said if gap.after < CLOSER * gap.tuned else f'{said}, as it does with tolerances alone'


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


def odds(nats: float) -> str:
    """Return evidence as odds against chance."""
    power = nats / math.log(10.0)
    if power < 1.0:
        return 'no better than chance' if nats <= 0.0 else f'odds of {math.exp(nats):.1f} to 1'
    return f'odds of 10{f"{power:.0f}".translate(RAISED)} to 1'


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
    if found.remains:
        first = found.remains[0]
        made.append(
            Tile('Unexplained', figure(first.floors, 2), '\N{MULTIPLICATION SIGN} the floor',
                 f'on {listed([one.axis for one in found.remains])}')
        )  # fmt: skip
    else:
        left = (
            f'a draught of {draught_size(found.draught)}, and no other force or moment'
            if found.draught
            else 'no force or moment is left over'
        )
        made.append(Tile('Unexplained', '0', 'axes', left))
    return made


def _verdict_tile(found: Finding) -> Tile:
    """Return the verdict as a tile."""
    count = sum(1 if len(one.knobs) > MANY else len(one.knobs) for one in found.effects)
    values = [
        f'{one.name.replace("_", " ")} {part.name.replace("_", " ")} {learned_words(part)}'
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
        rivals = any(one.confusable_with for one in found.effects)
        against = '; none against what it may be instead' if rivals else ''
        return Tile('Evidence', figure(least), 'nats', f'{which}{odds(least)}{against}')
    tried = [rung for step in found.ladder for rung in step]
    if not tried:
        return Tile('Evidence', MISSING, '', 'no candidate was worth a refit')
    best = max(tried, key=total)
    why = '' if best.accepted else f': {because(best, beaten=False)}'
    return Tile('Best candidate', figure(total(best)), 'nats', f'{spoken(best.knob)}{why}')


def total(rung: Rung) -> float:
    """Return the evidence that counts: of the training flights and the better witness. [nats]"""
    return rung.train + max(rung.confirm, rung.carried)


def because(rung: Rung, beaten: bool) -> str:
    """Return why a candidate was named, or was not; `beaten` where its round named another."""
    witness = max(rung.confirm, rung.carried)
    if rung.accepted:
        return 'named'
    if rung.train + witness <= GAIN or max(rung.train, witness) <= LARGER:
        return 'too little evidence'
    if rung.apart >= APART:
        return 'the flights disagree on its value'
    if beaten:
        return 'another explains it better'
    alone = rung.confirm > AGAIN and rung.carried > -SPOILT
    if alone or (rung.carried > HOLDS and rung.confirm > -TORN):
        return 'what no effect explains stands in its place'
    return 'the other flights do not confirm it'
