"""A comparison as one self-contained HTML file, in the look of a flight's page."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_config.command_line import format_lta_command, relative_path
from lta_data.compare import figures
from lta_data.compare.channel_comparison import ChannelComparison
from lta_data.compare.channel_roles import (
    RoleChannel,
    select_headline_channels,
    select_main_channels,
)
from lta_data.compare.comparison import ComparisonResult
from lta_data.compare.sentences import (
    BASIS,
    describe_comparison,
    describe_frames,
    find_earliest,
    format_channel_name,
    format_offset,
    format_offset_parts,
    format_quantity,
    format_verdict,
    MISSING,
)
from lta_data.compare.spectra import thin_spectra
from lta_data.compare.tables import (
    format_channel_table,
    format_fault_table,
    format_short_row,
    is_pickable,
)
from lta_data.compare.traces import encode_channel, encode_floats
from lta_report.formatting import Tile
from lta_report.page_frame import assemble_page, write_file
from lta_report.page_parts import embed_data, render_section, render_terms, render_tile
import numpy as np

NAME: Final = 'compare.html'
PICKED: Final = 320  # points of a line that somebody may pick
LEGEND: Final = (
    '<b class="key-a">Blue: A</b>, <b class="key-b">orange: B</b>, '
    '<b class="key-d">grey: B - A</b>. Shaded: the band that '
    'noise explains, or the tolerance. Nothing is drawn across a gap.'
)
ABOVE: Final = "Both paths in A's frame. Ring: start. Dot: end."


def write_page(comparison: ComparisonResult, out: Path) -> Path:
    """Write the page and return where it is; `BadInput` where it cannot be written."""
    return write_file(render_page(comparison), out)


def render_page(comparison: ComparisonResult) -> str:
    """Return the whole page."""
    shown, time = select_main_channels(comparison.channels), find_total_span(comparison)
    first = next((each for each in comparison.channels if is_pickable(each)), None)
    return assemble_page(
        'compare.html',
        title=escape(format_verdict(comparison)),
        kicker=escape(f'compare · A {shorten_path(comparison.a.path)} · B '
        f'{shorten_path(comparison.b.path)}'),
        about=escape(describe_comparison(comparison)),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(comparison)),
        hero=render_overview(comparison),
        panels='\n'.join(
            render_section(
                each.role.name, format_title(each), f'{each.channel.name}. '
                f'{summarize_channel(each.channel)}',
                figures.plot_overlay(each.channel, time),
                timed=True,
            )
            for each in shown
        ),
        picker='' if first is None else render_picker(comparison, first),
        channels=format_channel_table(comparison),
        faults=format_fault_table(comparison),
        applied=render_terms(describe_alignment(comparison)),
        remarks=''.join(f'<p class="note">{escape(text)}</p>' for text in comparison.remarks),
        facts=describe_sources(comparison),
        commands=suggest_commands(comparison),
    )  # fmt: skip


def find_total_span(comparison: ComparisonResult) -> tuple[float, float]:
    """Return the time that either flight covers, on A's clock. [s]"""
    ends = np.array([*comparison.a.span, *comparison.timing.map_to_a(np.array(comparison.b.span))])
    return float(ends.min()), float(ends.max())


def shorten_path(path: str) -> str:
    """Return what tells a bag from another: its folder's name, or the folder above `bag`."""
    given = Path(path)
    return given.parent.name if given.name == 'bag' and given.parent.name else given.stem


def format_title(entry: RoleChannel) -> str:
    """Return the heading of a panel."""
    if entry.among == 1:
        return entry.role.title
    field = entry.channel.name.rpartition('/')[2]
    return f'{entry.role.title}: {field}, which parts most of {entry.among}'


def summarize_channel(each: ChannelComparison) -> str:
    """Return how a channel stands, in a sentence."""
    found, when = each.measures, each.parting
    if each.verdict == 'identical':
        return 'Identical.'
    if found is None:
        return 'Never known in both.'
    rms = f'RMS {format_quantity(found.rms, each.unit)}'
    share = '' if found.nrmse is None else f", {found.nrmse:.2g} of A's standard deviation"
    parts = 'They do not part' if when.at is None else f'They part at {when.at:.2f} s'
    if when.at is None and each.verdict == 'apart at times':
        parts = f'They are apart at times, {100.0 * when.outside:.0f} % of the instants'
    return f'{parts}; {rms}{share}.'


def build_tiles(comparison: ComparisonResult) -> list[Tile]:
    """Return the figures that matter most."""
    timing, (begin, end) = comparison.timing, comparison.span
    parted = [each for each in comparison.channels if each.verdict == 'parted']
    moving = [
        each
        for each in select_headline_channels(comparison.channels)
        if each.parting.at is not None
    ] or parted
    wrong = sum(
        not each.is_clean
        for side in (comparison.faults_a, comparison.faults_b)
        for each in side.values()
    )
    offset, doubt, unit = format_offset_parts(timing)
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
            'Channels that part', str(len(parted)), f'of {len(comparison.channels)}',
            f'{sum(each.verdict == "identical" for each in comparison.channels)} identical',
        ),
    ]  # fmt: skip
    if moving:
        first, worst = find_earliest(moving), moving[0]
        made.append(
            Tile('First parting', f'{first.parting.at:.2f}', 's', format_channel_name(first))
        )
        rms = worst.measures
        share = MISSING if rms is None or rms.nrmse is None else f'{rms.nrmse:.2g}'
        made.append(Tile('NRMSE of what parts most', share, '', format_channel_name(worst)))
    else:
        made.append(Tile('First parting', MISSING, '', 'no channel parts'))
    made.append(Tile('Topics with faults', str(wrong), '', 'gaps, duplicates, lost values'))
    return made


def render_overview(comparison: ComparisonResult) -> str:
    """Return the path from above, where there is one, beside the first of the ranking."""
    above = figures.plot_path(comparison.channels)
    drawn = '' if above is None else render_section('path', 'From above', ABOVE, above)
    heads = ''.join(
        f'<th scope="col">{head}</th>' for head in ('channel', 'parts at', 'RMS', 'NRMSE')
    )
    moving = [each for each in comparison.channels if is_pickable(each)][:12]
    rows = ''.join(format_short_row(each) for each in moving)
    return (
        f'{drawn}<section class="panel ranking" aria-labelledby="title-ranking">'
        '<h2 id="title-ranking">What parts most and earliest</h2><table><thead><tr>'
        f'{heads}</tr></thead><tbody>{rows}</tbody></table>'
        f'<p class="note">{LEGEND} Times are A\'s. NRMSE is RMS over the standard deviation of A '
        'at the same instants.</p></section>'
    )


def render_picker(comparison: ComparisonResult, first: ChannelComparison) -> str:
    """Return the choice of any channel, with its overlay and spectra."""
    known = [each for each in comparison.channels if is_pickable(each)]
    options = ''.join(f'<option>{escape(each.name)}</option>' for each in known)
    content = {each.name: build_picker_data(each) for each in known}
    about = f'{first.name}. {summarize_channel(first)}'
    by_frequency = (
        "Power spectral density by Welch's method, in the channel's unit squared per hertz; "
        "coherence is the share of B's power that answers A's."
    )
    return (
        '<p class="choice"><label for="channel">Any channel</label> '
        f'<select id="channel">{options}</select></p><div class="grid">'
        + render_section(
            'channel',
            'Over time',
            about,
            figures.plot_overlay(first, find_total_span(comparison)),
            timed=True,
        )
        + render_section('spectrum', 'By frequency', by_frequency, figures.plot_spectrum(first))
        + f'</div>{embed_data("channels", content)}'
    )


def build_picker_data(each: ChannelComparison) -> dict[str, object]:
    """Return what the page's script needs of a channel."""
    content = {
        **encode_channel(each, PICKED),
        'summary': f'{each.name}. {summarize_channel(each)}',
    }
    found = None if each.spectra is None else thin_spectra(each.spectra)
    if found is not None:
        content['frequency'] = encode_floats(found.frequency)
        content['powers'] = [
            encode_floats(part) for part in (*figures.positive_powers(found), found.coherence)
        ]
    return content


def describe_alignment(comparison: ComparisonResult) -> Mapping[str, str]:
    """Return what was done to time and frames."""
    timing = comparison.timing
    told = {'time': timing.reason}
    if timing.how != 'none':
        told['offset'] = f"B's time {format_offset(timing)}"
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
    for each in comparison.frames:
        told[f'{each.topic}'] = describe_frames(each)
    return told


def describe_sources(comparison: ComparisonResult) -> dict[str, str]:
    """Return where the flights come from."""
    told = {}
    for label, side, only in (
        ('A', comparison.a, comparison.only_a),
        ('B', comparison.b, comparison.only_b),
    ):
        begin, end = side.span
        told[label] = str(relative_path(Path(side.path)))
        told[f'{label}, length'] = f'{end - begin:.2f} s'
        if side.robot:
            told[f'{label}, robot'] = side.robot
        if only:
            told[f'only in {label}'] = ', '.join(only)
    told['the same byte for byte'] = ', '.join(comparison.identical_topics) or 'no topic'
    told['commit'] = read_commit()
    return told


def suggest_commands(comparison: ComparisonResult) -> dict[str, str]:
    """Return how to go on."""
    a, b = relative_path(Path(comparison.a.path)), relative_path(Path(comparison.b.path))
    return {
        'Compare again': format_lta_command('compare', a, b),
        'In a script, status 1 where they differ': format_lta_command('compare', a, b, '--same'),
        'Look at A': format_lta_command('report', a),
    }
