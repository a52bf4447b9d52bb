"""Write a comparison as one self-contained HTML page."""

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
    select_panel_channels,
)
from lta_data.compare.comparison import ComparisonResult
from lta_data.compare.scene import READOUT, render_comparison_scene
from lta_data.compare.sentences import (
    BASIS,
    describe_comparison,
    describe_frames,
    find_earliest_divergence,
    format_channel_name,
    format_offset,
    format_offset_and_interval,
    format_quantity,
    format_verdict,
    MISSING,
)
from lta_data.compare.spectra import average_log_bands
from lta_data.compare.tables import (
    format_channel_table,
    format_fault_table,
    format_short_row,
    is_worth_plotting,
)
from lta_data.compare.traces import encode_channel, encode_floats
from lta_report.flight_scene import render_time_bar
from lta_report.formatting import Tile
from lta_report.html_elements import (
    embed_data,
    render_definition_list,
    render_section,
    render_tile,
)
from lta_report.page_frame import assemble_page, write_file
import numpy as np

NAME: Final = 'compare.html'
# All channels are embedded in the page for the picker
PICKED: Final = 320  # points of a line in the channel picker; limits the page's size
LEGEND: Final = (
    '<b class="key-a">Blue: A</b>, <b class="key-b">orange: B</b>, '
    '<b class="key-d">grey: B - A</b>. Shaded: the noise band '
    'or the tolerance. Gaps are not bridged.'
)
ABOVE: Final = "Both paths from above, in A's frame. Open circle: start. Filled circle: end."


def write_page(comparison: ComparisonResult, out: Path) -> Path:
    """Write the page and return its path; raise `BadInput` if it cannot be written."""
    return write_file(render_page(comparison), out)


def render_page(comparison: ComparisonResult) -> str:
    """Return the page's HTML."""
    shown, time = select_panel_channels(comparison.channels), find_total_span(comparison)
    scene, track = render_comparison_scene(comparison, time)
    first = next((each for each in comparison.channels if is_worth_plotting(each)), None)
    return assemble_page(
        'compare.html',
        title=escape(format_verdict(comparison)),
        kicker=escape(f'compare · A {shorten_path(comparison.a.path)} · B '
        f'{shorten_path(comparison.b.path)}'),
        about=escape(describe_comparison(comparison)),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(comparison)),
        track=track,
        has_scene=bool(scene),
        scene=scene,
        bar=render_time_bar(READOUT, 'flights') if scene else '',
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
        picker='' if first is None else render_channel_picker(comparison, first),
        channels=format_channel_table(comparison),
        faults=format_fault_table(comparison),
        applied=render_definition_list(describe_alignment(comparison)),
        remarks=''.join(f'<p class="note">{escape(text)}</p>' for text in comparison.remarks),
        facts=describe_sources(comparison),
        commands=suggest_commands(comparison),
    )  # fmt: skip


def find_total_span(comparison: ComparisonResult) -> tuple[float, float]:
    """Return the time that either flight covers, on A's clock. [s]"""
    ends = np.array(
        [*comparison.a.span, *comparison.timing.convert_to_a_time(np.array(comparison.b.span))]
    )
    return float(ends.min()), float(ends.max())


def shorten_path(path: str) -> str:
    """Return a short name of a bag: its folder's name, or that of the folder above `bag`."""
    given = Path(path)
    return given.parent.name if given.name == 'bag' and given.parent.name else given.stem


def format_title(entry: RoleChannel) -> str:
    """Return the heading of a panel."""
    if entry.among == 1:
        return entry.role.title
    field = entry.channel.name.rpartition('/')[2]
    return f'{entry.role.title}: {field}, which diverges most of {entry.among} channels'


def summarize_channel(each: ChannelComparison) -> str:
    """Return one sentence on a channel's difference."""
    found, when = each.measures, each.parting
    if each.verdict == 'identical':
        return 'Identical.'
    if found is None:
        return 'No common data.'
    rms = f'RMS difference {format_quantity(found.rms, each.unit)}'
    share = '' if found.nrmse is None else f", {found.nrmse:.2g} of A's standard deviation"
    parts = 'No divergence' if when.at is None else f'A and B diverge at {when.at:.2f} s'
    if when.at is None and each.verdict == 'apart at times':
        parts = f'A and B differ at times ({100.0 * when.outside:.0f} % of the samples)'
    return f'{parts}; {rms}{share}.'


def build_tiles(comparison: ComparisonResult) -> list[Tile]:
    """Return the tiles with the main results."""
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
    offset, doubt, unit = format_offset_and_interval(timing)
    doubt = f'± {doubt} {unit}; ' if doubt else ''
    how = {
        'clock': 'estimated from channels of both flights',
        'motion': 'estimated from the start of the motion',
        'given': 'set by hand',
        'none': 'time stamps unchanged' if timing.on_stamps else 'both flights start at 0 s',
    }[timing.how]  # fmt: skip
    made = [
        Tile('Offset of B\'s clock', offset, unit, f'{doubt}{how}'),
        Tile('Common time', f'{end - begin:.1f}', 's', f"{begin:.1f} to {end:.1f} s on A's clock"),
        Tile(
            'Diverging channels', str(len(parted)), f'of {len(comparison.channels)}',
            f'{sum(each.verdict == "identical" for each in comparison.channels)} identical',
        ),
    ]  # fmt: skip
    if moving:
        # The channels are sorted by score, so the first is the worst.
        first, worst = find_earliest_divergence(moving), moving[0]
        made.append(
            Tile('First divergence', f'{first.parting.at:.2f}', 's', format_channel_name(first))
        )
        rms = worst.measures
        share = MISSING if rms is None or rms.nrmse is None else f'{rms.nrmse:.2g}'
        made.append(Tile('NRMSE of the largest divergence', share, '', format_channel_name(worst)))
    else:
        made.append(Tile('First divergence', MISSING, '', 'no channel diverges'))
    made.append(Tile('Topics with faults', str(wrong), '', 'gaps, duplicates, missing values'))
    return made


def render_overview(comparison: ComparisonResult) -> str:
    """Return the path seen from above, if there is one, and the top of the ranking."""
    above = figures.plot_path(comparison.channels)
    drawn = '' if above is None else render_section('path', 'From above', ABOVE, above)
    heads = ''.join(
        f'<th scope="col">{head}</th>' for head in ('channel', 'diverges at', 'RMS', 'NRMSE')
    )
    moving = [each for each in comparison.channels if is_worth_plotting(each)][:12]
    rows = ''.join(format_short_row(each) for each in moving)
    return (
        f'{drawn}<section class="panel ranking" aria-labelledby="title-ranking">'
        '<h2 id="title-ranking">Largest and earliest divergences</h2><table><thead><tr>'
        f'{heads}</tr></thead><tbody>{rows}</tbody></table>'
        f'<p class="note">{LEGEND} Times are on A\'s clock. NRMSE is the RMS difference '
        'divided by the standard deviation of A at the same times.</p></section>'
    )


def render_channel_picker(comparison: ComparisonResult, first: ChannelComparison) -> str:
    """Return the channel picker with the overlay and spectra of the chosen channel."""
    known = [each for each in comparison.channels if is_worth_plotting(each)]
    options = ''.join(f'<option>{escape(each.name)}</option>' for each in known)
    content = {each.name: build_picker_data(each) for each in known}
    about = f'{first.name}. {summarize_channel(first)}'
    by_frequency = (
        "Power spectral density by Welch's method, in the channel's unit squared per hertz; "
        "coherence is the share of B's power that depends linearly on A."
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
    """Return the data that the page's script needs for a channel."""
    content = {
        **encode_channel(each, PICKED),
        'summary': f'{each.name}. {summarize_channel(each)}',
    }
    found = None if each.spectra is None else average_log_bands(each.spectra)
    if found is not None:
        content['frequency'] = encode_floats(found.frequency)
        content['powers'] = [
            encode_floats(part) for part in (*figures.positive_powers(found), found.coherence)
        ]
    return content


def describe_alignment(comparison: ComparisonResult) -> Mapping[str, str]:
    """Return how time and frames were aligned."""
    timing = comparison.timing
    terms = {'time': timing.reason}
    if timing.how != 'none':
        terms['offset'] = f"B's time {format_offset(timing)}"
        terms['estimated from'] = ', '.join(timing.used) or 'the given value'
    # An infinite deviation means that the drift was not estimated
    if timing.found is not None and timing.found.drift_sigma < 1.0:
        low, high = (
            # 1.96 standard deviations: 95 % of a normal distribution
            BASIS * (timing.found.drift + s * 1.96 * timing.found.drift_sigma)
            for s in (-1, 1)
        )
        what = 'applied' if timing.drift else 'not applied'
        terms["drift of B's clock"] = f'{low:+.0f} to {high:+.0f} ppm (95 % confidence); {what}'
    terms['reference of offsets'] = (
        'the time stamps of both flights'
        if timing.on_stamps
        else 'time since the start of each flight, because the time stamps do not overlap'
    )
    for each in comparison.frames:
        terms[f'{each.topic}'] = describe_frames(each)
    return terms


def describe_sources(comparison: ComparisonResult) -> dict[str, str]:
    """Return the origin of both flights."""
    terms = {}
    for label, side, only in (
        ('A', comparison.a, comparison.only_a),
        ('B', comparison.b, comparison.only_b),
    ):
        begin, end = side.span
        terms[label] = str(relative_path(Path(side.path)))
        terms[f'{label}, length'] = f'{end - begin:.2f} s'
        if side.robot:
            terms[f'{label}, robot'] = side.robot
        if only:
            terms[f'only in {label}'] = ', '.join(only)
    terms['identical byte for byte'] = ', '.join(comparison.identical_topics) or 'no topic'
    terms['commit'] = read_commit()
    return terms


def suggest_commands(comparison: ComparisonResult) -> dict[str, str]:
    """Return commands for further analysis."""
    a, b = relative_path(Path(comparison.a.path)), relative_path(Path(comparison.b.path))
    return {
        'Compare again': format_lta_command('compare', a, b),
        'Compare in a script: exit status 1 if they differ': format_lta_command(
            'compare', a, b, '--same'
        ),
        'Look at A': format_lta_command('report', a),
    }
