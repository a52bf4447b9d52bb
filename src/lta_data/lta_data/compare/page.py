"""A comparison as one self-contained HTML file, in the look of a flight's page."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import commit
from lta_config.typed import near, typed
from lta_data.compare import pictures
from lta_data.compare.apart import Apart
from lta_data.compare.comparison import Comparison
from lta_data.compare.roles import headline, main_channels, Shown
from lta_data.compare.spectra import thinned_spectra
from lta_data.compare.tables import channel_table, fault_table, pickable, short_row
from lta_data.compare.traces import packed, packed_channel
from lta_data.compare.words import (
    about,
    amount,
    BASIS,
    called,
    earliest,
    frame_words,
    MISSING,
    offset_figures,
    offset_words,
    verdict,
)
from lta_report.formatting import Tile
from lta_report.frame import framed, written
from lta_report.pieces import embedded, section, terms, tile_html
import numpy as np

NAME: Final = 'compare.html'
PICKED: Final = 320  # points of a line that somebody may pick
LEGEND: Final = (
    '<b class="key-a">Blue: A</b>, <b class="key-b">orange: B</b>, '
    '<b class="key-d">grey: B - A</b>. Shaded: the band that '
    'noise explains, or the tolerance. Nothing is drawn across a gap.'
)
ABOVE: Final = "Both paths in A's frame. Ring: start. Dot: end."


def write_page(found: Comparison, out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return written(page(found), out)


def page(found: Comparison) -> str:
    """Return the whole page."""
    shown, time = main_channels(found.channels), whole(found)
    first = next((each for each in found.channels if pickable(each)), None)
    return framed(
        'compare.html',
        title=escape(verdict(found)),
        kicker=escape(f'compare · A {short(found.a.path)} · B {short(found.b.path)}'),
        about=escape(about(found)),
        tiles='\n'.join(tile_html(*each) for each in tiles(found)),
        hero=hero(found),
        panels='\n'.join(
            section(
                each.role.name, title(each), f'{each.channel.name}. {summary(each.channel)}',
                pictures.overlay(each.channel, time),
                timed=True,
            )
            for each in shown
        ),
        picker='' if first is None else picker(found, first),
        channels=channel_table(found),
        faults=fault_table(found),
        applied=terms(applied(found)),
        remarks=''.join(f'<p class="note">{escape(text)}</p>' for text in found.remarks),
        facts=facts(found),
        commands=commands(found),
    )  # fmt: skip


def whole(found: Comparison) -> tuple[float, float]:
    """Return the time that either flight covers, on A's clock. [s]"""
    ends = np.array([*found.a.span, *found.timing.on_a(np.array(found.b.span))])
    return float(ends.min()), float(ends.max())


def short(path: str) -> str:
    """Return what tells a bag from another: its folder's name, or the folder above `bag`."""
    given = Path(path)
    return given.parent.name if given.name == 'bag' and given.parent.name else given.stem


def title(shown: Shown) -> str:
    """Return the heading of a panel."""
    if shown.among == 1:
        return shown.role.title
    field = shown.channel.name.rpartition('/')[2]
    return f'{shown.role.title}: {field}, which parts most of {shown.among}'


def summary(each: Apart) -> str:
    """Return how a channel stands, in a sentence."""
    found, when = each.measures, each.parting
    if each.verdict == 'identical':
        return 'Identical.'
    if found is None:
        return 'Never known in both.'
    rms = f'RMS {amount(found.rms, each.unit)}'
    share = '' if found.nrmse is None else f", {found.nrmse:.2g} of A's standard deviation"
    parts = 'They do not part' if when.at is None else f'They part at {when.at:.2f} s'
    if when.at is None and each.verdict == 'apart at times':
        parts = f'They are apart at times, {100.0 * when.outside:.0f} % of the instants'
    return f'{parts}; {rms}{share}.'


def tiles(found: Comparison) -> list[Tile]:
    """Return the figures that matter most."""
    timing, (begin, end) = found.timing, found.span
    parted = [each for each in found.channels if each.verdict == 'parted']
    moving = [each for each in headline(found.channels) if each.parting.at is not None] or parted
    wrong = sum(
        not each.clean for side in (found.faults_a, found.faults_b) for each in side.values()
    )
    offset, doubt, unit = offset_figures(timing)
    doubt = f'± {doubt} {unit}; ' if doubt else ''
    how = {
        'clock': 'by what both measured', 'motion': 'by the start of motion',
        'given': 'by hand',
        'none': 'stamps as they are' if timing.on_stamps else 'each from its own start',
    }[timing.how]  # fmt: skip
    made = [
        Tile('Offset of B\'s time', offset, unit, f'{doubt}{how}'),
        Tile('In common', f'{end - begin:.1f}', 's', f'{begin:.1f} to {end:.1f} s of A'),
        Tile(
            'Channels that part', str(len(parted)), f'of {len(found.channels)}',
            f'{sum(each.verdict == "identical" for each in found.channels)} identical',
        ),
    ]  # fmt: skip
    if moving:
        first, worst = earliest(moving), moving[0]
        made.append(Tile('First parting', f'{first.parting.at:.2f}', 's', called(first)))
        rms = worst.measures
        share = MISSING if rms is None or rms.nrmse is None else f'{rms.nrmse:.2g}'
        made.append(Tile('NRMSE of what parts most', share, '', called(worst)))
    else:
        made.append(Tile('First parting', MISSING, '', 'no channel parts'))
    made.append(Tile('Topics with faults', str(wrong), '', 'gaps, duplicates, lost values'))
    return made


def hero(found: Comparison) -> str:
    """Return the path from above, where there is one, beside the first of the ranking."""
    above = pictures.path(found.channels)
    drawn = '' if above is None else section('path', 'From above', ABOVE, above)
    heads = ''.join(
        f'<th scope="col">{head}</th>' for head in ('channel', 'parts at', 'RMS', 'NRMSE')
    )
    moving = [each for each in found.channels if pickable(each)][:12]
    rows = ''.join(short_row(each) for each in moving)
    return (
        f'{drawn}<section class="panel ranking" aria-labelledby="title-ranking">'
        '<h2 id="title-ranking">What parts most and earliest</h2><table><thead><tr>'
        f'{heads}</tr></thead><tbody>{rows}</tbody></table>'
        f'<p class="note">{LEGEND} Times are A\'s. NRMSE is RMS over the standard deviation of A '
        'at the same instants.</p></section>'
    )


def picker(found: Comparison, first: Apart) -> str:
    """Return the choice of any channel, with its overlay and spectra."""
    known = [each for each in found.channels if pickable(each)]
    options = ''.join(f'<option>{escape(each.name)}</option>' for each in known)
    content = {each.name: picked(each) for each in known}
    about = f'{first.name}. {summary(first)}'
    by_frequency = (
        "Power spectral density by Welch's method, in the channel's unit squared per hertz; "
        "coherence is the share of B's power that answers A's."
    )
    return (
        '<p class="choice"><label for="channel">Any channel</label> '
        f'<select id="channel">{options}</select></p><div class="grid">'
        + section('channel', 'Over time', about, pictures.overlay(first, whole(found)), timed=True)
        + section('spectrum', 'By frequency', by_frequency, pictures.spectrum(first))
        + f'</div>{embedded("channels", content)}'
    )


def picked(each: Apart) -> dict[str, object]:
    """Return what the page's script needs of a channel."""
    content = {**packed_channel(each, PICKED), 'summary': f'{each.name}. {summary(each)}'}
    found = None if each.spectra is None else thinned_spectra(each.spectra)
    if found is not None:
        content['frequency'] = packed(found.frequency)
        content['powers'] = [packed(part) for part in (*pictures.powers(found), found.coherence)]
    return content


def applied(found: Comparison) -> Mapping[str, str]:
    """Return what was done to time and frames."""
    timing = found.timing
    told = {'time': timing.reason}
    if timing.how != 'none':
        told['offset'] = f"B's time {offset_words(timing)}"
        told['resting on'] = ', '.join(timing.used) or 'what was given'
    if timing.found is not None and timing.found.drift_sigma < 1.0:
        low, high = (
            BASIS * (timing.found.drift + s * 1.96 * timing.found.drift_sigma) for s in (-1, 1)
        )
        what = 'applied' if timing.drift else 'not applied'
        told["drift of B's clock"] = f'{low:+.0f} to {high:+.0f} ppm (95 %); {what}'
    told['clock of offsets'] = (
        'that of the stamps'
        if timing.on_stamps
        else 'time since each start; the stamps have nothing in common'
    )
    for each in found.frames:
        told[f'{each.topic}'] = frame_words(each)
    return told


def facts(found: Comparison) -> dict[str, str]:
    """Return where the flights come from."""
    told = {}
    for label, side, only in (('A', found.a, found.only_a), ('B', found.b, found.only_b)):
        begin, end = side.span
        told[label] = str(near(Path(side.path)))
        told[f'{label}, length'] = f'{end - begin:.2f} s'
        if side.robot:
            told[f'{label}, robot'] = side.robot
        if only:
            told[f'only in {label}'] = ', '.join(only)
    told['the same byte for byte'] = ', '.join(found.identical_topics) or 'no topic'
    told['commit'] = commit()
    return told


def commands(found: Comparison) -> dict[str, str]:
    """Return how to go on."""
    a, b = near(Path(found.a.path)), near(Path(found.b.path))
    return {
        'Compare again': typed('compare', a, b),
        'In a script, status 1 where they differ': typed('compare', a, b, '--same'),
        'Look at A': typed('report', a),
    }
