"""Write the report of a platform comparison as one self-contained HTML file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
import math
from pathlib import Path
from typing import final

from lta_config.constants import STANDARD_GRAVITY
from lta_config.schema.comparison_file import ComparisonFile
from lta_config.schema.maneuver_file import load_maneuver_file, ManeuverFile
from lta_model.scenario import load_scenario
from lta_report.formatting import format_number, Tile
from lta_report.html_elements import render_html_table, render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_studies.platforms.entrants import build_entrant
from lta_studies.platforms.flight import Entrant
from lta_studies.platforms.pictures import (
    draw_ablations,
    draw_limits,
    draw_tracking,
    format_entry_name,
    UNIT,
)
from lta_studies.platforms.run import ABLATION, CONTESTANT, PlatformResult
from lta_studies.platforms.summary import (
    ComparisonCell,
    compute_lift_margin,
    find_top_speed,
    SeedMean,
    select_flights,
)
from lta_studies.platforms.verdict import format_headline, render_ablation_table
import yaml

NAME = 'report.html'
HEADS = ('platform', 'manoeuvre', 'held', 'overshoot', 'settles', 'steady error', 'rms', 'ripple',
         'height error', 'tilt')  # fmt: skip
DASHED = 'Dashed: setpoint. Flights with seed 1.'
LIMITED = (
    'One flight for each commanded speed. Dashed: the speed reached equals the speed '
    'commanded. The changes are listed below, under "What causes the differences".'
)
METHOD = (
    'Held: the platform settles before the last quarter, keeps its height within 0.2 m and '
    'does not turn over. Steady error (setpoint minus flown) and ripple: over the last '
    'quarter. Rms: over the whole rated interval. Values are means over the seeds with '
    'their 95 % interval (Student), which is missing for one seed or if it rounds to zero. '
    'Settling time: mean of the flights that settle.'
)


@final
@dataclass(frozen=True, slots=True)
class ComparisonReport:
    """Content of the page."""

    comparison: ComparisonFile
    rows: Sequence[PlatformResult]
    folder: Path
    origin: Mapping[str, str]


def write_page(report: ComparisonReport) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(report), report.folder / NAME)


def render_page(report: ComparisonReport) -> str:
    """Return the HTML of the page."""
    comparison, rows = report.comparison, report.rows
    shown, common = render_plot_sections(comparison, rows), len(comparison.manoeuvres)
    return assemble_page(
        'platforms.html',
        title=escape(format_headline(comparison, rows)),
        kicker=escape(f'comparison {comparison.name} · {comparison.scenario}'),
        about=escape(comparison.about),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(comparison, rows)),
        first='\n'.join(shown[:common]),
        pictures='\n'.join(shown[common:]),
        results=render_html_table(HEADS, build_result_rows(comparison, rows))
        + f'<p class="note">{METHOD}</p>',
        why=render_ablation_table(comparison, rows)
        + ''.join(
            [
                '<ul>',
                *(f'<li>{escape(each)}</li>' for each in describe_inputs_and_limits(report)),
                '</ul>',
            ]
        ),
        margins=render_platform_table(comparison),
        facts=report.origin,
        files={
            'Comparison file': yaml.safe_dump(
                comparison.model_dump(exclude_none=True), sort_keys=False
            )
        },
    )


def list_maneuvers(comparison: ComparisonFile, name: str) -> list[str]:
    """Return the manoeuvres of a contestant."""
    return comparison.contestants[name].manoeuvres or comparison.manoeuvres


def build_tiles(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> list[Tile]:
    """Return a tile with the number of manoeuvres held for each platform."""
    found = []
    for name, contestant in comparison.contestants.items():
        own = list_maneuvers(comparison, name)
        cells = [select_flights(rows, CONTESTANT, name, each) for each in own]
        held = sum(all(row.held for row in part.rows) for part in cells)
        lost = [each for each, part in zip(own, cells, strict=True)
                if not all(row.held for row in part.rows)]  # fmt: skip
        note = f'not: {", ".join(lost)}' if lost else 'manoeuvres held'
        found.append(Tile(contestant.title, f'{held}/{len(own)}', '', note))
    return found


def render_plot_sections(comparison: ComparisonFile, rows: Sequence[PlatformResult]) -> list[str]:
    """Return a section for each manoeuvre, the ablations and the speed limits."""
    own = [each for name in comparison.contestants for each in list_maneuvers(comparison, name)]
    names = dict.fromkeys([*comparison.manoeuvres, *own])  # common manoeuvres come first
    titles = {name: each.title for name, each in comparison.contestants.items()}
    found = []
    for name in names:
        manoeuvre = load_maneuver_file(name)
        picture = draw_tracking(rows, titles, manoeuvre)
        found.append(
            render_section(
                f'flown-{name}', name.capitalize(), f'{manoeuvre.about} {DASHED}', picture
            )
        )
    flown = dict.fromkeys(
        each for ablation in comparison.ablations.values() for each in ablation.manoeuvres
    )
    for name in flown:
        manoeuvre = load_maneuver_file(name)
        found.append(
            render_section(f'changed-{name}', f'{name.capitalize()}, with one part changed',
                    f'The changes are listed below, under "What causes the differences". {DASHED}',
                    draw_ablations(rows, comparison, manoeuvre))
        )  # fmt: skip
    if comparison.limits:
        found.append(
            render_section('limits', 'Speed limits', LIMITED, draw_limits(rows, comparison))
        )
    return found


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
    unit, factor = UNIT[manoeuvre.judge], find_unit_factor(manoeuvre)
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
        + UNIT['heading'],
    ]  # fmt: skip


def find_unit_factor(manoeuvre: ManeuverFile) -> float:
    """Return the factor from SI to the displayed unit."""
    return 180.0 / math.pi if manoeuvre.judge == 'heading' else 1.0


def format_mean(value: SeedMean, unit: str, factor: float, digits: int) -> str:
    """Format a mean with the half-width of its interval."""
    if math.isnan(value.value):
        return '\N{EN DASH}'
    text = format_number(value.value, digits, factor)
    # The interval is NaN for a single seed.
    half = 0.0 if math.isnan(value.high) else (value.high - value.value) * factor
    # Without an interval if it rounds to zero, so as not to claim an exact mean.
    spread = f' \N{PLUS-MINUS SIGN} {half:.{digits}f}' if round(half, digits) else ''
    # No space before the degree sign
    return f'{text}{spread}{"" if unit == UNIT["heading"] else " "}{unit}'


def describe_inputs_and_limits(report: ComparisonReport) -> list[str]:
    """Return sentences on open-loop inputs and speed limits."""
    comparison, rows = report.comparison, report.rows
    found = format_open_loop_inputs(comparison, rows)
    for name, limit in comparison.limits.items():
        held, reached = find_top_speed(comparison, rows, name)
        title = comparison.contestants[limit.of].title
        why = f' ({limit.why})' if limit.why else ''
        found.append(
            f'{title}{why}: keeps its height at commanded speeds up to {held:.2f} m/s, and '
            f'reaches {reached:.2f} m/s at most.'
        )
    return found


def format_open_loop_inputs(
    comparison: ComparisonFile, rows: Sequence[PlatformResult]
) -> list[str]:
    """Return the duty inputs of open-loop platforms in the climb manoeuvre."""
    sentences = []
    for name, contestant in comparison.contestants.items():
        flying = rebuild_entrant(comparison, name)
        for row in rows:
            same = (row.job.kind, row.job.name) == (CONTESTANT, name) and row.duties is not None
            if flying.law.name == 'open_loop' and same and row.job.manoeuvre == 'climb':
                steps = [
                    f'from {time:.1f} s {", ".join(f"{each:.3f}" for each in duties)}'
                    for time, duties in find_duty_intervals(row)
                ]
                order = ', '.join(flying.vehicle.rotor_names)
                sentences.append(
                    f'{contestant.title} flies the climb in open loop. The duties of the rotors '
                    f'({order}) are: {"; ".join(steps)}.'
                )
    return sentences


def find_duty_intervals(row: PlatformResult) -> list[tuple[float, list[float]]]:
    """Return the start time and the duties of each interval; at most eight."""
    found: list[tuple[float, list[float]]] = []
    for time, duties in zip(row.flown[:, 0].tolist(), row.duties.tolist(), strict=True):
        # A new interval begins where any duty changes by over 0.1 %.
        if not found or max(abs(p - q) for p, q in zip(found[-1][1], duties, strict=True)) > 1e-3:
            found.append((time, duties))
    return found[:8]


def rebuild_entrant(comparison: ComparisonFile, name: str) -> Entrant:
    """Rebuild a contestant as flown."""
    density = load_scenario(comparison.scenario).air.density
    return build_entrant(comparison.contestants[name], density)


def render_platform_table(comparison: ComparisonFile) -> str:
    """Return the table of control laws, feedback sources and lift margins."""
    lines = []
    for name, contestant in comparison.contestants.items():
        flying = rebuild_entrant(comparison, name)
        lift, weight = compute_lift_margin(flying.vehicle)
        newtons = [f'{format_number(force, 1, 1e3)} mN' for force in (lift, weight, lift - weight)]
        grams = f'{format_number((lift - weight) / STANDARD_GRAVITY, 1, 1e3)} g'
        seen = str(flying.law.feedback)
        lines.append([contestant.title, flying.law.name.replace('_', ' '), seen, *newtons, grams])
    heads = ('platform', 'law', 'feedback', 'full lift', 'weight to carry', 'margin', 'margin')
    return render_html_table(heads, lines) + (
        '<p class="note">Vertical lift of all lifting rotors at full thrust. Laws with tracker '
        'feedback get pose and velocity from motion capture, as their authors did.</p>'
    )
