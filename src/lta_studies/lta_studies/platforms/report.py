# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Build the report of a platform comparison."""

from collections.abc import Iterator, Mapping, Sequence
import math

from lta_config.constants import STANDARD_GRAVITY
from lta_config.schema.comparison_file import ComparisonFile, load_maneuver_file, ManeuverFile
from lta_flight.sweep.statistics import MeanInterval
from lta_model.scenario import load_scenario
from lta_report.formatting import format_amount, format_number, MISSING, Tile
from lta_report.report import Block, Emphasis, Grid, Picture, Report, TextSection, TextTable
from lta_studies.platforms.flight import build_entrant, Entrant
from lta_studies.platforms.run import ABLATION, CONTESTANT, PlatformResult, result_to_json
from lta_studies.platforms.summary import (
    ComparisonCell,
    compute_lift_margin,
    draw_ablations,
    draw_limits,
    draw_tracking,
    find_top_speed,
    format_entry_name,
    select_flights,
    SIGNAL_UNITS,
)
import yaml

RESULT_HEADS = (
    'platform', 'manoeuvre', 'held', 'overshoot', 'settles', 'steady error', 'rms', 'ripple',
    'height error', 'tilt',
)  # fmt: skip
SETPOINT_NOTE = 'Dashed: setpoint. Flights with seed 1.'
CHANGES_NOTE = 'The changes are listed below, under "What causes the differences".'
LIMIT_CAPTION = (
    'One flight for each commanded speed. Dashed: the speed reached equals the speed '
    f'commanded. {CHANGES_NOTE}'
)
PLATFORM_METHOD = (
    'Held: the platform settles before the last quarter, keeps its height within 0.2 m and '
    'does not turn over. Steady error (setpoint minus flown) and ripple: over the last '
    'quarter. Rms: over the whole rated interval. Values are means over the seeds with '
    'their 95 % interval (Student), which is missing for one seed or if it rounds to zero. '
    'Settling time: mean of the flights that settle.'
)
MARGINS = (
    'Vertical lift of all lifting rotors at full thrust. Laws with tracker feedback get pose and '
    'velocity from motion capture, as their authors did.'
)
ABLATION_NOTE = (
    'Flights held before and after the change; bold where the change reverses the majority.'
)


def build_report(
    comparison: ComparisonFile,
    rows: Sequence[PlatformResult],
    facts: Mapping[str, str],
) -> Report:
    """Return the report of a comparison; `facts` are its origin."""
    content = yaml.safe_dump(comparison.model_dump(exclude_none=True), sort_keys=False)
    return Report(
        command='platforms',
        subject=f'{comparison.name} · {comparison.scenario}',
        headline=format_headline(comparison, rows),
        introduction=comparison.about,
        tiles=build_tiles(comparison, rows),
        blocks=[
            *build_pictures(comparison, rows),
            TextTable(
                'All platforms and manoeuvres', RESULT_HEADS, build_result_rows(comparison, rows),
                PLATFORM_METHOD, printed=False,
            ),
            *explain_differences(comparison, rows),
            build_platform_table(comparison),
        ],
        data=[result_to_json(row) for row in rows],
        json_name='flights.json',
        facts=facts,
        files={'Comparison file': content},
    )  # fmt: skip


def format_headline(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> str:
    """Return the headline."""
    lost = []
    for name, contestant in comparison.contestants.items():
        own_rows = [row for row in rows if (row.job.kind, row.job.name) == (CONTESTANT, name)]
        if not own_rows or not all(row.held for row in own_rows):
            lost.append(contestant.title)
    count = len(comparison.contestants)
    if not lost:
        who = f'All {count} contestants hold' if count > 1 else 'The one contestant holds'
        return f'{who} every manoeuvre.'
    if len(lost) == count:
        return 'No contestant holds every manoeuvre.'
    return (
        f'{count - len(lost)} of {count} contestants hold every manoeuvre; {join_names(lost)} not.'
    )


def join_names(names: Sequence[str]) -> str:
    """Join names to the subject of 'does' or 'do'."""
    # 'A does', 'A and B do', 'A, B and C do'
    *others, last = names
    return f'{", ".join(others)} and {last} do' if others else f'{last} does'


def list_maneuvers(comparison: ComparisonFile, name: str) -> list[str]:
    """Return the manoeuvres of a contestant."""
    return comparison.contestants[name].manoeuvres or comparison.manoeuvres


def build_tiles(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> list[Tile]:
    """Return a tile with the number of manoeuvres held for each platform."""
    tiles = []
    for name, contestant in comparison.contestants.items():
        own = list_maneuvers(comparison, name)
        cells = [select_flights(rows, CONTESTANT, name, each) for each in own]
        held = sum(all(row.held for row in part.rows) for part in cells)
        lost = [each for each, part in zip(own, cells, strict=True)
                if not all(row.held for row in part.rows)]  # fmt: skip
        note = f'not: {", ".join(lost)}' if lost else 'manoeuvres held'
        tiles.append(Tile(contestant.title, f'{held}/{len(own)}', '', note))
    return tiles


def build_pictures(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> Iterator[Block]:
    """Yield the figures of the manoeuvres, of the ablations, and of the speed limits."""
    titles = {name: each.title for name, each in comparison.contestants.items()}
    common = comparison.manoeuvres
    own = [each for name in comparison.contestants for each in list_maneuvers(comparison, name)]
    names = [each for part in comparison.ablations.values() for each in part.manoeuvres]

    def draw_maneuver(name: str) -> Picture:
        manoeuvre = load_maneuver_file(name)
        figure = draw_tracking(rows, titles, manoeuvre)
        caption = f'{manoeuvre.about} {SETPOINT_NOTE}'
        return Picture(f'flown-{name}', name.capitalize(), caption, figure, height=320)

    def draw_changed(name: str) -> Picture:
        figure = draw_ablations(rows, comparison, load_maneuver_file(name))
        heading = f'{name.capitalize()}, with one part changed'
        return Picture(
            f'changed-{name}', heading, f'{CHANGES_NOTE} {SETPOINT_NOTE}', figure, height=320
        )

    yield Grid([draw_maneuver(name) for name in common])
    others = [draw_maneuver(name) for name in dict.fromkeys(own) if name not in common]
    others += map(draw_changed, dict.fromkeys(names))
    if others:
        yield Grid(others)
    if comparison.limits:
        figure = draw_limits(rows, comparison)
        yield Picture('limits', 'Speed limits', LIMIT_CAPTION, figure, height=420)


def build_result_rows(
    comparison: ComparisonFile, rows: Sequence[PlatformResult]
) -> list[list[str]]:
    """Return a row for each platform and manoeuvre, followed by the ablations."""
    lines = [
        [contestant.title, *format_row_cells(select_flights(rows, CONTESTANT, name, each), each)]
        for name, contestant in comparison.contestants.items()
        for each in list_maneuvers(comparison, name)
    ]
    return lines + [
        [
            format_entry_name(comparison, name),
            *format_row_cells(select_flights(rows, ABLATION, name, each), each),
        ]
        for name, ablation in comparison.ablations.items()
        for each in ablation.manoeuvres
    ]


def format_row_cells(part: ComparisonCell, name: str) -> list[str]:
    """Return the cells of one row."""
    manoeuvre = load_maneuver_file(name)
    held = sum(row.held for row in part.rows)
    unit, factor = SIGNAL_UNITS[manoeuvre.judge], find_unit_factor(manoeuvre)
    # The tilt is always shown in degrees.
    degrees = 180.0 / math.pi
    return [
        name,
        f'{held} of {len(part.rows)}',
        format_mean(part.mean_metric('overshoot'), '%', 100.0, 1),
        format_mean(part.mean_metric('settling_time'), 's', 1.0, 1),
        *(format_mean(part.mean_metric(each), unit, factor, 3 if factor == 1.0 else 1)
          for each in ('steady_error', 'rms', 'ripple')),
        format_mean(part.mean_metric('steady_error', 'height'), 'm', 1.0, 3),
        format_number(max((row.tilt for row in part.rows), default=0.0), 1, degrees)
        + SIGNAL_UNITS['heading'],
    ]  # fmt: skip


def find_unit_factor(manoeuvre: ManeuverFile) -> float:
    """Return the factor from SI to the displayed unit."""
    return 180.0 / math.pi if manoeuvre.judge == 'heading' else 1.0


def format_mean(value: MeanInterval, unit: str, factor: float, digits: int) -> str:
    """Format a mean with the half-width of its interval."""
    if math.isnan(value.value):
        return MISSING
    text = format_number(value.value, digits, factor)
    # The interval is NaN for a single seed.
    half = 0.0 if math.isnan(value.high) else (value.high - value.value) * factor
    # Without an interval if it rounds to zero, so as not to claim an exact mean.
    spread = f' \N{PLUS-MINUS SIGN} {half:.{digits}f}' if round(half, digits) else ''
    # No space before the degree sign
    return f'{text}{spread}{"" if unit == SIGNAL_UNITS["heading"] else " "}{unit}'


def explain_differences(
    comparison: ComparisonFile, rows: Sequence[PlatformResult]
) -> Iterator[Block]:
    """Yield the table of ablations, and sentences on speed limits."""
    if comparison.ablations:
        yield build_ablation_table(comparison, rows)
    lines = []
    for name, limit in comparison.limits.items():
        held, reached = find_top_speed(comparison, rows, name)
        title = comparison.contestants[limit.of].title
        why = f' ({limit.why})' if limit.why else ''
        lines.append(
            f'{title}{why}: keeps its height at commanded speeds up to {held:.2f} m/s, and '
            f'reaches {reached:.2f} m/s at most.'
        )
    if lines:
        yield TextSection('Speed limits', lines, bullets=True)


def build_ablation_table(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> TextTable:
    """Return the table of ablations: flights held before and after the change."""
    # One column for every manoeuvre that any ablation flies
    names = list(
        dict.fromkeys(each for part in comparison.ablations.values() for each in part.manoeuvres)
    )
    lines = [
        [
            format_entry_name(comparison, name), comparison.contestants[ablation.of].title,
            ablation.why,
            *(
                format_before_after(
                    select_flights(rows, CONTESTANT, ablation.of, each),
                    select_flights(rows, ABLATION, name, each),
                )
                for each in names
            ),
        ]
        for name, ablation in comparison.ablations.items()
    ]  # fmt: skip
    heads = ('entry', 'based on', 'change', *names)
    return TextTable('What causes the differences', heads, lines, ABLATION_NOTE, printed=False)


def format_before_after(base: ComparisonCell, changed: ComparisonCell) -> str:
    """Format the flights held before and after a change, bold if the majority reverses."""
    if not base.rows or not changed.rows:
        return MISSING
    held = [sum(row.held for row in part.rows) for part in (base, changed)]
    counts = [len(part.rows) for part in (base, changed)]
    # Whether the majority of flights held
    most = [2 * few > all_of for few, all_of in zip(held, counts, strict=True)]
    ends = [f'{few}/{all_of}' for few, all_of in zip(held, counts, strict=True)]
    text = ' \N{RIGHTWARDS ARROW} '.join(ends)
    return Emphasis(text) if most[0] != most[1] else text


def rebuild_entrant(comparison: ComparisonFile, name: str) -> Entrant:
    """Rebuild a contestant as flown."""
    density = load_scenario(comparison.scenario).air.density
    return build_entrant(comparison.contestants[name], density)


def build_platform_table(comparison: ComparisonFile) -> TextTable:
    """Return the table of control laws, feedback sources and lift margins."""
    lines = []
    for name, contestant in comparison.contestants.items():
        flying = rebuild_entrant(comparison, name)
        lift, weight = compute_lift_margin(flying.vehicle)
        lines.append([
            contestant.title, flying.law.name.replace('_', ' '), str(flying.law.feedback),
            *(format_amount(force, 'mN', 1, 1e3) for force in (lift, weight, lift - weight)),
            format_amount((lift - weight) / STANDARD_GRAVITY, 'g', 1, 1e3),
        ])  # fmt: skip
    heads = (
        'platform', 'law', 'feedback', 'full lift', 'weight to carry', 'lift to spare',
        'mass to spare',
    )  # fmt: skip
    return TextTable('Control laws and stability margins', heads, lines, MARGINS, printed=False)
