"""
Whether a study contradicts itself: what its headline, tiles, tables, terminal and JSON say.

Each law is asked of the words themselves and not of what they are made from, so that a page that
is changed in one place only is found.
"""

from collections.abc import Iterator
from html import unescape
from io import StringIO
from pathlib import Path
import re
from typing import Any, Final, final, NamedTuple

from lta_discovery.finding import Finding
from lta_discovery.page import tables
from lta_discovery.page.verdict_words import about, headline, learned_commands, tiles
from lta_discovery.page.words import spoken
from lta_discovery.results.discovery_json import to_dict
from lta_discovery.results.terminal import show
from rich.console import Console

COLUMNS: Final = 80
TAG: Final = re.compile('<[^>]+>')
CLAIMS: Final = re.compile(
    '(?!It may be|Something|Nothing|No effect|These flights).* (is|are) missing'
)
NOTHING: Final = 'Nothing is missing'
BETTER: Final = ('falls from', 'takes the', 'Use the vehicle file with what was learned')
DOUBT: Final = (
    'cannot tell', 'Fly again', 'do not trust', 'predicts worse', 'forecasts are worse',
    'it does not tell',
)  # fmt: skip
FITS: Final = 'explains these flights to within'
UNFIT: Final = ('want more than', 'Measure the numbers')


@final
class Rendered(NamedTuple):
    """What a study says in each place, as plain text."""

    headline: str
    tiles: str
    effects: str
    ladder: str
    rest: str
    terminal: str
    commands: str
    json: dict[str, Any]

    @property
    def all(self) -> str:
        """Everything but the JSON."""
        return '\n'.join(self[:-1])


def render(found: Finding) -> Rendered:
    """Return what a study says in each place."""
    out = StringIO()
    show(found, Console(file=out, width=COLUMNS, color_system=None))
    rest = (tables.following(found), tables.warned(found), tables.unexplained(found))
    return Rendered(
        headline(found),
        '\n'.join(' '.join(map(str, one)) for one in tiles(found)),
        _strip_tags(tables.effects(found)),
        _strip_tags(tables.ladder(found)),
        '\n'.join([about(found), *map(_strip_tags, rest)]),
        out.getvalue(),
        '\n'.join(learned_commands(found, Path('found')).values()),
        to_dict(found),
    )


def _strip_tags(html: str) -> str:
    """Return the words of HTML."""
    return ' '.join(unescape(TAG.sub(' ', html)).split())


def find_contradictions(found: Finding) -> list[str]:
    """Return what a study asserts and retracts, a sentence each; none is as it should be."""
    said = render(found)
    laws = (_check_gains(said), _check_names(found, said), _check_nothing(found, said),
            _check_values(found, said), _check_json(found, said))  # fmt: skip
    return [each for law in laws for each in law]


def _check_gains(said: Rendered) -> Iterator[str]:
    """Yield where a gain is told, or the learned file offered, and it should not be used."""
    keep = 'keep the vehicle file' in said.all.lower()
    doubted = 'do not trust its value' in said.all or 'Fly again' in said.all
    for words in BETTER:
        if words in said.all and (keep or doubted):
            yield f"'{words}' beside the advice not to use it"
    if ' fly --vehicle' in said.commands and (keep or doubted):
        yield 'the learned file is to be flown and is not to be used'
    if 'no cause for doubt' in said.all and any(words in said.all for words in DOUBT):
        yield 'doubt beside no cause for it'


def _check_names(found: Finding, said: Rendered) -> Iterator[str]:
    """Yield names that are asserted without their rivals, or that do not stand at the end."""
    for one in found.effects:
        for rival in one.confusable_with:
            if found.verdict != 'not_identifiable' and spoken(rival) not in said.headline:
                yield f'the headline keeps silent about {rival}'
        folded = ''.join(said.terminal.split())
        if one.name not in folded:
            yield f'{one.name} is not whole on a terminal of {COLUMNS} columns'
    if '\N{HORIZONTAL ELLIPSIS}' in said.terminal:
        yield f'something is cut on a terminal of {COLUMNS} columns'
    if CLAIMS.match(said.headline) and (found.verdict == 'not_identifiable' or not found.effects):
        yield 'a name is asserted that the verdict does not have'
    named = {name.partition('.')[0] for one in found.effects for name in one.knobs}
    for knob in (rung.knob for step in found.ladder for rung in step):
        heading = f'{spoken(knob)} is named'
        stays = said.ladder.count(heading) > said.ladder.count(f'{heading}, and given up')
        if stays and knob.partition('.')[0] not in named:
            yield f'{knob} is named in a round and not at the end'


def _check_nothing(found: Finding, said: Rendered) -> Iterator[str]:
    """Yield where nothing is said to be missing, and something is."""
    more = found.effects or found.remains or found.unexplained
    if NOTHING in said.headline and (more or 'Unexplained:' in said.terminal):
        yield 'nothing is missing, and something is'
    if 'no force or moment is left over' in said.tiles and (found.remains or found.unexplained):
        yield 'nothing is left over, and something is unexplained'
    if FITS in said.effects and any(words in said.all for words in UNFIT):
        yield 'the file explains the flights, and has to be measured again'


def _check_values(found: Finding, said: Rendered) -> Iterator[str]:
    """Yield values of the file that it lacks, and values that hide what they depend on."""
    lacking = sum(not each.in_file for one in found.effects for each in one.parameters)
    if said.effects.count('the file does not have it') != lacking:
        yield 'a value of the file that it lacks'
    assumed = sum(bool(one.assumed) for one in found.effects)
    if said.effects.count('assumed and not fitted') != assumed:
        yield 'a value that depends on an assumed one does not say so'


def _check_json(found: Finding, said: Rendered) -> Iterator[str]:
    """Yield where the JSON draws another conclusion than the words."""
    drawn = said.json['conclusion']
    gain = any(words in said.headline for words in BETTER)
    if gain != (drawn['gain'] is not None):
        yield 'a gain in the headline or in the JSON alone'
    if drawn['asserted'] != (bool(found.effects) and 'cannot tell' not in said.headline):
        yield 'asserted by the headline or by the JSON alone'
    if drawn['do'] not in said.terminal.replace('\n', ' ') or drawn['do'] not in said.rest:
        yield 'the advice is not the same everywhere'
