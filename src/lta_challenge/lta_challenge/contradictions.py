"""
Detect contradictions between the headline, tiles, tables, terminal and JSON of a study.

The checks read the rendered texts and not the data behind them, so that they detect a text that
was changed in only one place.
"""

from collections.abc import Iterator
from html import unescape
from io import StringIO
from pathlib import Path
import re
from typing import Any, Final, final, NamedTuple

from lta_discovery.finding import StudyResult
from lta_discovery.page import tables
from lta_discovery.page.formatting import format_parameter
from lta_discovery.page.verdict_text import (
    build_tiles,
    format_details,
    format_flight_roles,
    format_headline,
    list_learned_file_commands,
)
from lta_discovery.results.discovery_json import to_dict
from lta_discovery.results.terminal import print_finding
from rich.console import Console

COLUMNS: Final = 80
# Ends of sentences inside a text
SENTENCES: Final = re.compile(r'\. (?=[A-Z])')
TAG: Final = re.compile('<[^>]+>')
# Headlines that assert a missing effect; the lookahead excludes guesses and negations
CLAIMS: Final = re.compile('(?!.*These flights).* (is|are) missing')
NOTHING: Final = 'no effect that the model lacks'
BETTER: Final = ('falls from', 'tolerances reduces the', 'Use the corrected vehicle file')
AGAIN: Final = 'Record another flight before'
IDLE: Final = 'no forecast shows'
DOUBT: Final = (
    'inconclusive', 'cannot distinguish', AGAIN, 'do not trust', 'predicts worse',
    'effects found are worse', 'do not show which', IDLE,
)  # fmt: skip
FITS: Final = 'explains these flights to within'
REMEASURE: Final = 'Calibrate first'
UNFIT: Final = ('standard deviations of their tolerance', 'Measure the parameters')


@final
class RenderedStudy(NamedTuple):
    """The outputs of a study as plain text."""

    headline: str  # with the sentences below it
    tiles: str
    effects: str
    ladder: str
    rest: str
    terminal: str
    commands: str
    json: dict[str, Any]

    @property
    def text_without_json(self) -> str:
        """Everything but the JSON."""
        # The last field is the JSON
        return '\n'.join(self[:-1])


def render_study(finding: StudyResult) -> RenderedStudy:
    """Render all outputs of a study as plain text."""
    out = StringIO()
    # As on a terminal: into a file, a table would be as wide as it needs
    console = Console(file=out, width=COLUMNS, color_system=None, force_terminal=True)
    print_finding(finding, console)
    rest = (
        tables.render_next_steps(finding),
        tables.render_warnings(finding),
        tables.render_unexplained(finding),
    )
    return RenderedStudy(
        f'{format_headline(finding)} {format_details(finding)}'.strip(),
        '\n'.join(' '.join(map(str, one)) for one in build_tiles(finding)),
        _strip_tags(tables.render_effects(finding)),
        _strip_tags(tables.render_search_rounds(finding)),
        '\n'.join([format_flight_roles(finding), *map(_strip_tags, rest)]),
        out.getvalue(),
        '\n'.join(list_learned_file_commands(finding, Path('found')).values()),
        to_dict(finding),
    )


def _strip_tags(html: str) -> str:
    """Return the text of HTML, with single spaces."""
    return ' '.join(unescape(TAG.sub(' ', html)).split())


def find_contradictions(finding: StudyResult) -> list[str]:
    """Return a sentence for each contradiction; empty if there are none."""
    rendered = render_study(finding)
    laws = (_check_gains(rendered), _check_names(finding, rendered),
            _check_status(finding, rendered),
            _check_nothing(finding, rendered), _check_values(finding, rendered),
            _check_json(finding, rendered), _check_law(rendered),
            _check_refit(rendered), _check_added(finding, rendered))  # fmt: skip
    return [each for law in laws for each in law]


def _check_gains(rendered: RenderedStudy) -> Iterator[str]:
    """Check that no gain is reported and no learned file offered that should not be used."""
    keep = 'keep the vehicle file' in rendered.text_without_json.lower()
    doubted = (
        'do not trust the values' in rendered.text_without_json
        or AGAIN in rendered.text_without_json
    )
    for words in BETTER:
        if words in rendered.text_without_json and (keep or doubted):
            yield f"the text says '{words}', but the advice is not to use the learned file"
    if ' fly --vehicle' in rendered.commands and (keep or doubted):
        yield 'a command uses the learned vehicle file, but the advice is not to use it'
    if 'no cause for doubt' in rendered.text_without_json and any(
        words in rendered.text_without_json for words in DOUBT
    ):
        yield 'the study states a doubt, but also "no cause for doubt"'


def _check_names(finding: StudyResult, rendered: RenderedStudy) -> Iterator[str]:
    """Check that named effects appear with their rivals and in every output."""
    for one in finding.effects:
        for rival in one.confusable_with:
            if (
                finding.verdict != 'not_identifiable'
                and format_parameter(rival) not in rendered.headline
            ):
                yield f'the headline does not mention {rival}, which explains the flights as well'
        # Remove line breaks: a narrow terminal may wrap a long name
        folded = ''.join(rendered.terminal.split())
        if one.name not in folded:
            yield f'the effect name {one.name} is cut off in a terminal of {COLUMNS} columns'
    if '\N{HORIZONTAL ELLIPSIS}' in rendered.terminal:
        yield f'a text is cut off in a terminal of {COLUMNS} columns'
    if CLAIMS.match(rendered.headline) and (
        finding.verdict == 'not_identifiable' or not finding.effects
    ):
        yield 'the headline names a missing effect, but the result contains none'
    named = {name.partition('.')[0] for one in finding.effects for name in one.knobs}
    for knob in (rung.knob for step in finding.ladder for rung in step):
        # A parameter may be named in one round and dropped in a later one
        if _stays(rendered.ladder, knob, 'named') and knob.partition('.')[0] not in named:
            yield f'parameter {knob} is named in a search round, but not in the result'


def _stays(ladder: str, knob: str, status: str) -> bool:
    """Return whether a search round gives a parameter a status that it keeps."""
    heading = f'{format_parameter(knob)} is {status}'
    return ladder.count(heading) > ladder.count(f'{heading}, but dropped')


def _check_status(finding: StudyResult, rendered: RenderedStudy) -> Iterator[str]:
    """Check that each output calls the effects named if they are said to be missing, or none."""
    conclusion = rendered.json['conclusion']
    asserted = conclusion['asserted']
    calls = {
        'the JSON verdict': rendered.json['verdict'].startswith('named'),
        'a tile': ' named ' in rendered.tiles,
        'the terminal': 'with the named effects' in rendered.terminal,
        'a search round': any(
            _stays(rendered.ladder, rung.knob, 'named') for step in finding.ladder for rung in step
        ),
    }
    for place, is_named in calls.items():
        if is_named and not asserted:
            yield f'{place} names an effect that is not said to be missing'
    if asserted and not (calls['the JSON verdict'] and calls['a tile']):
        yield 'an effect is said to be missing, but verdict or tile do not name it'
    law = rendered.json['law']
    if 'vehicle.yaml' in rendered.commands and not (asserted or (law and law['proposed'])):
        yield 'a command uses a learned file, but nothing is named'


def _check_nothing(finding: StudyResult, rendered: RenderedStudy) -> Iterator[str]:
    """Check that "nothing is missing" is stated only if that is the result."""
    more = finding.effects or finding.remains or finding.unexplained
    if NOTHING in rendered.headline and (more or 'Unexplained:' in rendered.terminal):
        yield 'the headline says that nothing is missing, but the result names an effect or force'
    if 'no unexplained force or moment' in rendered.tiles and (
        finding.remains or finding.unexplained
    ):
        yield 'a tile says that no force remains, but the result has an unexplained force'
    if FITS in rendered.effects and any(words in rendered.text_without_json for words in UNFIT):
        yield 'the file explains the flights, but the advice is to measure its numbers again'


def _check_values(finding: StudyResult, rendered: RenderedStudy) -> Iterator[str]:
    """Check the values of the file and the notes on assumed values."""
    lacking = sum(not each.in_file for one in finding.effects for each in one.parameters)
    if rendered.effects.count('not in the vehicle file') != lacking:
        yield 'the table shows a vehicle-file value for a parameter that the file does not have'
    assumed = sum(bool(one.assumed) for one in finding.effects)
    if rendered.effects.count('assumed and not fitted') != assumed:
        yield 'an estimate depends on an assumed value, but the table does not say so'


def _check_json(finding: StudyResult, rendered: RenderedStudy) -> Iterator[str]:
    """Check that JSON and texts draw the same conclusion."""
    conclusion = rendered.json['conclusion']
    if len(SENTENCES.findall(conclusion['headline'])) > 1:
        yield 'the headline has more than two sentences'
    if f'{conclusion["headline"]} {conclusion["details"]}'.strip() != rendered.headline:
        yield 'headline and JSON differ'
    gain = any(words in rendered.headline for words in BETTER)
    if gain != (conclusion['gain'] is not None):
        yield 'headline and JSON disagree on whether the prediction improves'
    # The first two phrases are those of an undecided result
    undecided = any(words in rendered.headline for words in (*DOUBT[:2], IDLE))
    if conclusion['asserted'] != (bool(finding.effects) and not undecided):
        yield 'headline and JSON disagree on whether an effect is missing'
    if (
        conclusion['do'] not in rendered.terminal.replace('\n', ' ')
        or conclusion['do'] not in rendered.rest
    ):
        yield 'the page, the terminal and the JSON give different advice'


def _check_law(rendered: RenderedStudy) -> Iterator[str]:
    """Check that all outputs agree on whether a law is proposed."""
    law = rendered.json['law']
    proposed = bool(law and law['proposed'])
    folded = ' '.join(rendered.terminal.split())
    if ('A law of ' in rendered.headline) != proposed:
        yield 'headline and JSON disagree on whether a law is proposed'
    if ('A law describes it' in folded) != proposed or ('No law is proposed' in folded) == (
        proposed or law is None
    ):
        yield 'terminal and JSON disagree on whether a law is proposed'
    if proposed and rendered.json['conclusion']['advice'] not in ('law', 'use'):
        yield 'a law is proposed, but the advice is not to use the file that holds it'
    if law and proposed == bool(law['reason']):
        yield 'a law is proposed and rejected at once'


def _check_refit(rendered: RenderedStudy) -> Iterator[str]:
    """Check that all outputs agree on whether the refitted file forecasts best."""
    conclusion = rendered.json['conclusion']
    best = conclusion['refitted'] is not None
    if ('With all numbers refitted, ' in rendered.headline) != best:
        yield 'headline and JSON disagree on whether the refitted file forecasts best'
    if ('use refitted.yaml' in conclusion['do']) != best:
        yield 'the advice and the JSON disagree on whether to predict with the refitted file'
    if best and (REMEASURE in rendered.headline or 'no improvement: coasting' in conclusion['do']):
        yield 'the refitted file forecasts best, but the headline says to calibrate first'
    if (conclusion['advice'] == 'refitted') > best:
        yield 'the advice is the refitted file, which does not forecast best'


def _check_added(finding: StudyResult, rendered: RenderedStudy) -> Iterator[str]:
    """Check that effects are only advised if forecasts with them beat fitted tolerances."""
    conclusion = rendered.json['conclusion']
    beats = any(
        (gap['added_ci95'][0] or 0.0) > 0.0 or (gap['tuned'] is None and gap['after'] is not None)
        for gap in rendered.json['gaps']
    )
    if finding.effects and conclusion['advice'] == 'use' and not beats:
        yield 'effects are advised that improve no forecast over fitted tolerances'
    vain = IDLE in rendered.headline
    if vain and (conclusion['advice'] == 'use' or conclusion['asserted']):
        yield 'the headline says that no forecast shows the effects, but the JSON asserts them'
    if vain and BETTER[2] in rendered.text_without_json:
        yield 'the headline says that no forecast shows the effects, but their file is advised'
    if vain != (' possible ' in rendered.tiles):
        yield 'headline and tiles disagree on whether forecasts show the effects'
    if conclusion['advice'] != 'use' and 'falls from' in rendered.headline:
        yield 'the headline states a gain by effects that are not advised'
