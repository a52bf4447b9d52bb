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

from lta_discovery.finding import DiscoveryFinding
from lta_discovery.page import tables
from lta_discovery.page.formatting import format_parameter
from lta_discovery.page.verdict_text import (
    build_tiles,
    format_headline,
    list_learned_commands,
    summarize_flights,
)
from lta_discovery.results.discovery_json import to_dict
from lta_discovery.results.terminal import print_finding
from rich.console import Console

COLUMNS: Final = 80
TAG: Final = re.compile('<[^>]+>')
CLAIMS: Final = re.compile(
    '(?!It may be|Something|Nothing|No effect|These flights).* (is|are) missing'
)
NOTHING: Final = 'Nothing is missing'
BETTER: Final = ('falls from', 'takes the', 'Use the vehicle file with what was learned')
DOUBT: Final = (
    'inconclusive', 'cannot distinguish', 'Fly again', 'do not trust', 'predicts worse',
    'forecasts are worse', 'does not show which',
)  # fmt: skip
FITS: Final = 'explains these flights to within'
UNFIT: Final = ('need more than', 'Measure the numbers')


@final
class RenderedStudy(NamedTuple):
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
    def whole_text(self) -> str:
        """Everything but the JSON."""
        return '\n'.join(self[:-1])


def render_study(finding: DiscoveryFinding) -> RenderedStudy:
    """Return what a study says in each place."""
    out = StringIO()
    print_finding(finding, Console(file=out, width=COLUMNS, color_system=None))
    rest = (
        tables.render_next_steps(finding),
        tables.render_warnings(finding),
        tables.render_unexplained(finding),
    )
    return RenderedStudy(
        format_headline(finding),
        '\n'.join(' '.join(map(str, one)) for one in build_tiles(finding)),
        _strip_tags(tables.render_effects(finding)),
        _strip_tags(tables.render_ladder(finding)),
        '\n'.join([summarize_flights(finding), *map(_strip_tags, rest)]),
        out.getvalue(),
        '\n'.join(list_learned_commands(finding, Path('found')).values()),
        to_dict(finding),
    )


def _strip_tags(html: str) -> str:
    """Return the words of HTML."""
    return ' '.join(unescape(TAG.sub(' ', html)).split())


def find_contradictions(finding: DiscoveryFinding) -> list[str]:
    """Return what a study asserts and retracts, a sentence each; none is as it should be."""
    said = render_study(finding)
    laws = (_check_gains(said), _check_names(finding, said), _check_nothing(finding, said),
            _check_values(finding, said), _check_json(finding, said))  # fmt: skip
    return [each for law in laws for each in law]


def _check_gains(rendered: RenderedStudy) -> Iterator[str]:
    """Yield where a gain is told, or the learned file offered, and it should not be used."""
    keep = 'keep the vehicle file' in rendered.whole_text.lower()
    doubted = 'do not trust its value' in rendered.whole_text or 'Fly again' in rendered.whole_text
    for words in BETTER:
        if words in rendered.whole_text and (keep or doubted):
            yield f"'{words}' beside the advice not to use it"
    if ' fly --vehicle' in rendered.commands and (keep or doubted):
        yield 'the learned file is to be flown and is not to be used'
    if 'no cause for doubt' in rendered.whole_text and any(
        words in rendered.whole_text for words in DOUBT
    ):
        yield 'doubt beside no cause for it'


def _check_names(finding: DiscoveryFinding, rendered: RenderedStudy) -> Iterator[str]:
    """Yield names that are asserted without their rivals, or that do not stand at the end."""
    for one in finding.effects:
        for rival in one.confusable_with:
            if (
                finding.verdict != 'not_identifiable'
                and format_parameter(rival) not in rendered.headline
            ):
                yield f'the headline keeps silent about {rival}'
        folded = ''.join(rendered.terminal.split())
        if one.name not in folded:
            yield f'{one.name} is not whole on a terminal of {COLUMNS} columns'
    if '\N{HORIZONTAL ELLIPSIS}' in rendered.terminal:
        yield f'something is cut on a terminal of {COLUMNS} columns'
    if CLAIMS.match(rendered.headline) and (
        finding.verdict == 'not_identifiable' or not finding.effects
    ):
        yield 'a name is asserted that the verdict does not have'
    named = {name.partition('.')[0] for one in finding.effects for name in one.knobs}
    for knob in (rung.knob for step in finding.ladder for rung in step):
        heading = f'{format_parameter(knob)} is named'
        stays = rendered.ladder.count(heading) > rendered.ladder.count(f'{heading}, but dropped')
        if stays and knob.partition('.')[0] not in named:
            yield f'{knob} is named in a round and not at the end'


def _check_nothing(finding: DiscoveryFinding, rendered: RenderedStudy) -> Iterator[str]:
    """Yield where nothing is said to be missing, and something is."""
    more = finding.effects or finding.remains or finding.unexplained
    if NOTHING in rendered.headline and (more or 'Unexplained:' in rendered.terminal):
        yield 'nothing is missing, and something is'
    if 'no force or moment remains' in rendered.tiles and (
        finding.remains or finding.unexplained
    ):
        yield 'nothing is left over, and something is unexplained'
    if FITS in rendered.effects and any(words in rendered.whole_text for words in UNFIT):
        yield 'the file explains the flights, and has to be measured again'


def _check_values(finding: DiscoveryFinding, rendered: RenderedStudy) -> Iterator[str]:
    """Yield values of the file that it lacks, and values that hide what they depend on."""
    lacking = sum(not each.in_file for one in finding.effects for each in one.parameters)
    if rendered.effects.count('the file does not have it') != lacking:
        yield 'a value of the file that it lacks'
    assumed = sum(bool(one.assumed) for one in finding.effects)
    if rendered.effects.count('assumed and not fitted') != assumed:
        yield 'a value that depends on an assumed one does not say so'


def _check_json(finding: DiscoveryFinding, rendered: RenderedStudy) -> Iterator[str]:
    """Yield where the JSON draws another conclusion than the words."""
    drawn = rendered.json['conclusion']
    gain = any(words in rendered.headline for words in BETTER)
    if gain != (drawn['gain'] is not None):
        yield 'a gain in the headline or in the JSON alone'
    undecided = any(words in rendered.headline for words in DOUBT[:2])
    if drawn['asserted'] != (bool(finding.effects) and not undecided):
        yield 'asserted by the headline or by the JSON alone'
    if drawn['do'] not in rendered.terminal.replace('\n', ' ') or drawn['do'] not in rendered.rest:
        yield 'the advice is not the same everywhere'
