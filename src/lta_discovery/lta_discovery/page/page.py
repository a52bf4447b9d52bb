"""A study as one self-contained HTML file, in the look of a flight's page."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any, Final

from lta_config.typed import typed
from lta_discovery.finding import Finding
from lta_discovery.page import errors, pictures, tables
from lta_discovery.page.carried import carried
from lta_discovery.page.latent import followed, joined, latents
from lta_discovery.page.told import Overlay, overlay, Seen, seen, together
from lta_discovery.page.verdict_words import about, headline, learned_commands, tiles
from lta_discovery.page.whiteness import autocorrelation, GROUPS, spectrum
from lta_discovery.page.words import listed, remainder_words, size_unit
from lta_discovery.study import Study
from lta_model.effects.protocol import AXES
from lta_report.frame import framed, written
from lta_report.palette import DARK, ESTIMATE, FILL, GOOD, LAMP, TRUTH, WALL
from lta_report.pieces import embedded, section, tile_html
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Bags = Mapping[Any, Sequence[Path | str]]
NONE: Final[Bags] = {}
NAME: Final = 'report.html'
COLOURS: Final = {
    'before': ESTIMATE, 'tuned': LAMP, 'after': TRUTH, 'coast': WALL, 'floor': FILL,
    'evidence': GOOD,
}  # fmt: skip
HEAT: Final = (
    'Each column is a piece of some seconds, each row a channel; the darker, the further the '
    'model is off in units of the noise. Pale all over is a model that explains the flight. A '
    'piece begins as suits it best, and the offset of a sensor is taken out. Flights that taught '
    'or confirmed are shown as fitted.'
)
CONDITIONS: Final = (
    'The error of the pose of each piece against what it flew like: orange as the vehicle file '
    'has it, blue with what was learned. What rises to one side tells where to look.'
)
ABOVE: Final = (
    'Each piece begins where it was measured, and nobody helps it on its way. Broad grey: '
    'measured; orange: the vehicle file; blue: with what was learned.'
)
OVER: Final = (
    'The same over time; below, how far each prediction is from what was measured, from the '
    'beginning of its piece on.'
)
WHITE: Final = (
    'How what is left over goes with itself a little later. Noise drops to 0 at once and stays '
    'between the dashes; a model that misses something decays slowly.'
)
POWER: Final = (
    'What is left over by frequency, in units of the noise: the dashes are white noise of the '
    'size that was measured. A rise to the left is motion that the model does not have.'
)
NOBODY: Final = '<p class="absent">There is no flight to draw.</p>'


def write_page(study: Study, folder: Path, bags: Bags = NONE) -> Path:
    """
    Write the page of a study and return where it is.

    Parameters
    ----------
    study : Study
        What was found, and the flights.
    folder : Path
        Where the results of the study are.
    bags : mapping of role to paths
        As they were named on the command line, for the command that does it again; the names of
        the flights by default.

    Raises
    ------
    BadInput
        If the page cannot be written.

    """
    return written(page(study, folder, bags), folder / NAME)


def page(study: Study, folder: Path, bags: Bags = NONE) -> str:
    """Return the whole page."""
    found, flights = study.finding, seen(study)
    drawn = [overlay(one, sum(each.shown for each in flights)) for one in flights if one.shown]
    names = [one.flown.name for one in flights if one.shown]
    colours = COLOURS | {f'{key}_dark': DARK[colour] for key, colour in COLOURS.items()}
    return framed(
        'discover.html',
        title=escape(headline(found)),
        kicker=escape(f'discover · {found.vehicle} · {len(study.flights)} flights'),
        about=escape(about(found)),
        tiles='\n'.join(tile_html(*each) for each in tiles(found)),
        effects=tables.effects(found),
        gaps=errors.gaps(found),
        channels=errors.by_channel(found),
        where=where(found, flights),
        places=tables.places(found),
        ladder=carried(found) + tables.ladder(found),
        overlays=overlays(names, drawn),
        white=white(flights),
        remains=remains(study),
        following=tables.following(found),
        seen=tables.detectable(found),
        warnings=tables.warned(found),
        facts=facts(found),
        commands=commands(found, folder, bags or found.bags),
        files={},
        drawn=True,
        **colours,
    )


def where(found: Finding, flights: Sequence[Seen]) -> str:
    """Return the pictures of where the model is off."""
    if not any(len(one.before.time) for one in flights):
        return NOBODY
    return section(
        'heat', 'Where and when the model is off', HEAT, pictures.heat(flights, found.where)
    ) + section(
        'conditions', 'In which conditions', CONDITIONS, pictures.by_condition(flights)
    )  # fmt: skip


def overlays(names: Sequence[str], drawn: Sequence[Overlay]) -> str:
    """Return the overlay of one flight, and a choice where there are several."""
    if not drawn:
        return NOBODY
    first, choice = drawn[0], ''
    if len(drawn) > 1:
        options = ''.join(
            f'<option value="{k}">{escape(name)}</option>' for k, name in enumerate(names)
        )
        content = {str(k): _packed(one) for k, one in enumerate(drawn) if k}
        choice = (
            '<p class="choice"><label for="flight">Flight</label> '
            f'<select id="flight">{options}</select></p>{embedded("flights", content)}'
        )
    return (
        f'{choice}<div class="grid">'
        + section('above', 'Before and after, from above', ABOVE, pictures.path(first))
        + section(
            'overtime',
            'Before and after, over time',
            OVER,
            pictures.over_time(first),
            timed=True,
        )
        + '</div>'
    )


def _packed(one: Overlay) -> dict[str, object]:
    """Return what the page's script needs of a flight."""
    return {
        'begin': one.begin,
        'period': one.period,
        'lines': [[short(column) for column in line.T] for line in one.lines],
    }


def short(values: Array) -> dict[str, object]:
    """Return a line in two bytes a number, to be multiplied by `scale`; the least is NaN."""
    largest = float(np.nanmax(np.abs(values), initial=0.0)) or 1.0
    factor = largest / 32000.0
    numbers = np.where(np.isfinite(values), np.round(values / factor), -32768.0).astype('<i2')
    return {'scale': factor, 'data': b64encode(numbers.tobytes()).decode()}


def white(flights: Sequence[Seen]) -> str:
    """Return the pictures of how much like noise what is left over is."""
    both = [together(flights, after) for after in (False, True)]
    if not any(len(each) for each in both[0]):
        return NOBODY
    kinds = list(zip(('before', 'after'), (pictures.BEFORE, pictures.AFTER), both, strict=True))
    rows, powers = [], []
    for part in GROUPS.values():
        of = [(name, colour, [each[..., part] for each in left]) for name, colour, left in kinds]
        rows.append([(name, colour, *autocorrelation(left)[:2]) for name, colour, left in of])
        powers.append([(name, colour, *spectrum(left)) for name, colour, left in of])
    titles = list(GROUPS)
    correlated = pictures.lines(rows, titles, 'later', 's')
    band = autocorrelation([each[..., GROUPS['position']] for each in both[0]])[2]
    for level in (-band, band):
        pictures.levelled(correlated, level)
    by_frequency = pictures.lines(powers, titles, 'frequency', 'Hz')
    by_frequency.update_xaxes(type='log', tickvals=[0.2, 0.5, 1, 2, 5, 10]).update_yaxes(
        type='log', exponentformat='power', dtick=1
    )
    pictures.levelled(by_frequency, 1.0)
    return section('white', 'Is what is left over noise?', WHITE, correlated) + section(
        'power', 'What is left over, by frequency', POWER, by_frequency
    )


def remains(study: Study) -> str:
    """Return what no effect explains, drawn; that nothing remains where that is so."""
    found = study.finding
    if not found.remains:
        more = 'else ' if found.draught else ''
        said = f'Nothing {more}stands clear of the floor on any axis.'
        return f'{tables.unexplained(found)}<p class="note">{said}</p>'
    return tables.unexplained(found) + tables.remains(found) + _drawn(study)


def _drawn(study: Study) -> str:
    """Return the latent force over time, and against what it follows."""
    flights, found = latents(study), study.finding
    if not flights:
        return ''
    top = found.remains[:3]
    rows = [
        [
            (each.name, colour, *joined(each, AXES.index(one.axis)))
            for each, colour in zip(flights, (pictures.AFTER, pictures.BEFORE), strict=False)
        ]
        for one in top
    ]
    titles = [f'{one.axis} [{size_unit(one)}]' for one in top]
    names = listed(
        [f'{word} {each.name}' for word, each in zip(('blue', 'orange'), flights, strict=False)]
    )
    made = section(
        'latent', 'The force that nothing explains, over time',
        f'As the flights themselves show it, {names}.',
        pictures.lines(rows, titles, 'time', 's'),
    )  # fmt: skip
    known = flights[0].terms
    following = next((one for one in found.remains if known.keys() & set(one.follows)), None)
    if following is not None:
        axis, unit = AXES.index(following.axis), size_unit(following)
        made += section(
            'follows', f'What the {following.axis} part follows',
            f'{remainder_words(following).capitalize()}. On the dashes, those terms would '
            'explain it all.',
            pictures.scatter(
                followed(flights, axis, following.follows),
                [np.where(each.known, each.wrench[..., axis], np.nan).ravel() for each in flights],
                [each.name for each in flights],
                (f'{listed(following.follows)}, fitted [{unit}]', f'{following.axis} [{unit}]'),
            ),
        )  # fmt: skip
    return f'<div class="grid drawn">{made}</div>'


def facts(found: Finding) -> Mapping[str, str]:
    """Return where the page comes from."""
    roles = {'train': 'learned from', 'confirm': 'confirmed by', 'holdout': 'held out'}
    return {
        'vehicle': found.vehicle,
        **{
            words: listed(found.bags[role])
            for role, words in roles.items()
            if found.bags.get(role)
        },
        'seed': str(found.seed),
        **found.versions,
    }


def commands(found: Finding, folder: Path, bags: Bags) -> Mapping[str, str]:
    """Return how to do it again, and how to go on."""
    words = ['--vehicle', found.vehicle]
    for role in ('train', 'confirm', 'holdout'):
        if bags.get(role):
            words += [f'--{role}', *map(str, bags[role])]
    again = typed('discover', *words, '--seed', str(found.seed))
    return {'do it again': again, **learned_commands(found, folder)}
