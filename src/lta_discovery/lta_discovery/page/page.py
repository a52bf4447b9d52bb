"""Render a study as one self-contained HTML file."""

import base64
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any, Final

from lta_config.command_line import format_lta_command
from lta_discovery.calibration.report import build_first_step_table, FIRST_STEP
from lta_discovery.calibration.verdict import format_forecast_sentence
from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import StudyResult
from lta_discovery.page import error_tables, figures, tables
from lta_discovery.page.flight_views import (
    build_flight_views,
    build_overlay,
    FlightOverlay,
    select_residuals,
    StudyFlightView,
)
from lta_discovery.page.formatting import format_remainder, join_words, remainder_unit
from lta_discovery.page.latent_wrench import collect_latent_wrenches, fit_terms, join_pieces
from lta_discovery.page.law_section import render_law
from lta_discovery.page.scene import READOUT, render_study_scene
from lta_discovery.page.transfer_table import render_transfer
from lta_discovery.page.verdict_text import (
    build_tiles,
    format_details,
    format_flight_roles,
    format_headline,
    list_learned_file_commands,
)
from lta_discovery.page.whiteness import autocorrelation, GROUPS, residual_spectrum
from lta_discovery.study import DiscoveryStudy
from lta_model.effects.protocol import AXES
from lta_model.vehicle import Vehicle
from lta_report.flight_scene import pack_column, render_time_bar
from lta_report.formatting import format_count
from lta_report.html_elements import embed_data, render_colors, render_section
from lta_report.page_frame import write_file
from lta_report.palette import ESTIMATE, FILL, GOOD, LAMP, TIME, TRUTH, WALL
from lta_report.report import HtmlBlock, Report
from lta_report.report_page import render_panel, render_report
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Bags = Mapping[Any, Sequence[Path | str]]
NONE: Final[Bags] = {}
NAME: Final = 'report.html'
COLOURS: Final = {
    'before': ESTIMATE, 'tuned': LAMP, 'after': TRUTH, 'refitted': TIME[0], 'coast': WALL,
    'floor': FILL, 'evidence': GOOD,
}  # fmt: skip
HEAT: Final = (
    'Each column is a few seconds of flight, each row a channel. A darker cell means a larger '
    'error relative to the measurement noise; if the model explains the flight, all cells are '
    'pale. The initial state of each piece is fitted, and sensor offsets are removed. Training '
    'and confirming flights are shown as fitted.'
)
CONDITIONS: Final = (
    'Pose error of each piece against its flight conditions: orange with the vehicle file, blue '
    'with the learned effects. Errors that rise to one side show where to look.'
)
ABOVE: Final = (
    'Each piece starts at the measured state and is predicted without correction. Thick grey: '
    'measured; orange: predicted with the vehicle file; blue: predicted with the learned effects.'
)
OVER: Final = (
    'Height and heading, measured and predicted. Below: the distance between predicted and '
    'measured position, which grows from the start of each piece.'
)
WHITE: Final = (
    'Autocorrelation of the residuals. White noise drops to 0 at once and stays '
    'between the dashed lines; if the model lacks something, the curve decays slowly.'
)
POWER: Final = (
    'Spectrum of the residuals relative to the noise; the dashed line is white noise of the '
    'measured size. A rise at low frequencies is motion that the model lacks.'
)
AGAIN: Final = (
    'Numbers that any vehicle file must have come before effects that a model may lack. Below, '
    'the vehicle file is the calibrated one.'
)
EVIDENCE: Final = (
    '<p class="note"><i class="key one"></i>evidence from the training flights <i class="key two">'
    '</i>evidence from the confirming flights, fitted alone or with the value from the training '
    'flights, whichever is larger <i class="key mark"></i>evidence required to name an effect. '
    'The unit is the nat: one more nat is 2.7 times as likely.</p>'
)
GLANCE: Final = (
    'Animation: a flight in 3-D beside the prediction of the vehicle file, which drifts off, and '
    'then the prediction with the learned effects, which follows it'
)
NOBODY: Final = '<p class="absent">There is no flight to draw.</p>'


def write_page(study: DiscoveryStudy, folder: Path, bags: Bags = NONE) -> Path:
    """
    Write the page of a study and return its path.

    `bags`: as on the command line, for the command that repeats the study; the names of the
    flights by default. Raise `BadInput` if the page cannot be written.
    """
    report = build_report(study, build_flight_views(study), folder, bags)
    return write_file(render_report(report), folder / NAME)


def build_report(
    study: DiscoveryStudy,
    flights: Sequence[StudyFlightView],
    folder: Path,
    bags: Bags = NONE,
    vehicle: Vehicle | None = None,
    drawing: str = '',
) -> Report:
    """Return the report; the vehicle is that of the 3-D view, the drawing the animation."""
    finding = study.finding
    overlays = [
        build_overlay(one, sum(each.shown for each in flights)) for one in flights if one.shown
    ]
    names = [one.study_flight.name for one in flights if one.shown]
    scene, track = render_study_scene(overlays, vehicle)
    whiteness = f'<div class="grid">{render_whiteness(flights)}</div>'
    panels = (
        (FIRST_STEP, render_calibration(finding)),
        ('', render_story(finding, drawing)),
        ('Prediction errors', error_tables.render_pose_errors(finding)),
        ('', f'<div class="grid pair">{render_discrepancies(finding, flights)}</div>'),
        ('Largest disagreements', tables.render_discrepancies(finding)),
        (
            'Evidence of each candidate effect',
            EVIDENCE + render_transfer(finding) + tables.render_search_rounds(finding),
        ),
        ('', render_overlays(names, overlays) + whiteness),
        ('Unexplained forces and moments', render_remainders(study) + render_law(study)),
        ('Which flight informs which number', tables.render_flight_information(finding)),
        ('Detection limits of the effects', tables.render_detection_limits(finding)),
        ('Channel by channel', error_tables.render_channel_errors(finding)),
    )
    return Report(
        command='discover',
        subject=f'{finding.vehicle} · {format_count(len(study.flights), "flight")}',
        headline=format_headline(finding),
        introduction=f'{format_details(finding)} {format_flight_roles(finding)}'.strip(),
        tiles=build_tiles(finding),
        blocks=[HtmlBlock(html, heading) for heading, html in panels if html],
        data={},
        facts=list_provenance(finding),
        commands=list_commands(finding, folder, bags or finding.bags),
        scene=scene,
        time_bar=render_time_bar(READOUT, 'flight') if scene else '',
        track=track,
        asset='discover.html',
    )


def render_story(finding: StudyResult, drawing: str) -> str:
    """Return what was found, what to do next, and the warnings, in columns."""
    parts = {
        _format_effects_heading(finding): tables.render_effects(finding),
        'What to do next': tables.render_next_steps(finding),
        'Warnings': tables.render_warnings(finding),
        'At a glance': render_glance(drawing),
    }
    panels = (render_panel(heading, body) for heading, body in parts.items() if body)
    return f'{render_colors(COLOURS)}<div class="column">{"".join(panels)}</div>'


def _format_effects_heading(finding: StudyResult) -> str:
    """Return the heading of the effects."""
    possible = draw_conclusion(finding).effect_status == 'possible'
    return 'Possible effects' if possible else 'Missing effects'


def render_calibration(finding: StudyResult) -> str:
    """Return the content of the section of a calibration before the search; '' without one."""
    if finding.calibration is None:
        return ''
    table = build_first_step_table(finding.calibration)
    rows = [[escape(str(cell)) for cell in row] for row in table.rows]
    return (
        f'<p class="note">{escape(format_forecast_sentence(finding.calibration))} {AGAIN}</p>'
        f'{tables.render_table(table.heads, rows, "calibration", FIRST_STEP)}'
    )


def render_glance(drawing: str) -> str:
    """Return the animation, or nothing if there is none."""
    if not drawing:
        return ''
    # An image of its own: its styles do not reach the page
    content = base64.b64encode(drawing.encode()).decode()
    return f'<img class="glance" alt="{GLANCE}" src="data:image/svg+xml;base64,{content}">'


def render_discrepancies(finding: StudyResult, flights: Sequence[StudyFlightView]) -> str:
    """Return the figures of where the model is off."""
    if not any(len(one.before.time) for one in flights):
        return NOBODY
    return render_section(
        'heat', 'Where and when the model is off', HEAT,
        figures.plot_error_map(flights, finding.where),
    ) + render_section(
        'conditions', 'In which conditions', CONDITIONS, figures.plot_error_by_condition(flights)
    )  # fmt: skip


def render_overlays(names: Sequence[str], lines: Sequence[FlightOverlay]) -> str:
    """Return the overlay of the first flight, and a menu if there are several."""
    if not lines:
        return NOBODY
    first, choice = lines[0], ''
    if len(lines) > 1:
        options = ''.join(
            f'<option value="{k}">{escape(name)}</option>' for k, name in enumerate(names)
        )
        # The first flight is in the figure already
        content = {str(k): _pack_overlay(one) for k, one in enumerate(lines) if k}
        choice = (
            '<p class="choice"><label for="flight">Flight</label> '
            f'<select id="flight">{options}</select></p>{embed_data("flights", content)}'
        )
    return (
        f'{choice}<div class="grid">'
        + render_section(
            'above', 'Measured and predicted path, from above', ABOVE, figures.plot_path(first)
        )
        + render_section(
            'overtime',
            'Measured and predicted motion over time',
            OVER,
            figures.plot_time_series(first),
            timed=True,
        )
        + '</div>'
    )


def _pack_overlay(one: FlightOverlay) -> dict[str, object]:
    """Return the data that the page's script needs of a flight."""
    return {
        'begin': one.begin,
        'period': one.period,
        'lines': [[pack_column(column) for column in line.T] for line in one.lines],
    }


def render_whiteness(flights: Sequence[StudyFlightView]) -> str:
    """Return the figures of residual autocorrelation and spectrum."""
    both = [select_residuals(flights, after) for after in (False, True)]
    if not any(len(each) for each in both[0]):
        return NOBODY
    kinds = list(zip(('before', 'after'), (figures.BEFORE, figures.AFTER), both, strict=True))
    rows, powers = [], []
    for part in GROUPS.values():
        of = [(name, colour, [each[..., part] for each in left]) for name, colour, left in kinds]
        rows.append([(name, colour, *autocorrelation(left)[:2]) for name, colour, left in of])
        powers.append([(name, colour, *residual_spectrum(left)) for name, colour, left in of])
    titles = list(GROUPS)
    correlated = figures.plot_stacked_curves(rows, titles, 'later', 's')
    band = autocorrelation([each[..., GROUPS['position']] for each in both[0]])[2]
    for level in (-band, band):
        figures.mark_level(correlated, level)
    by_frequency = figures.plot_stacked_curves(powers, titles, 'frequency', 'Hz')
    by_frequency.update_xaxes(type='log', tickvals=[0.2, 0.5, 1, 2, 5, 10]).update_yaxes(
        type='log', exponentformat='power', dtick=1
    )
    figures.mark_level(by_frequency, 1.0)
    return render_section('white', 'Are the residuals noise?', WHITE, correlated) + render_section(
        'power', 'Residuals by frequency', POWER, by_frequency
    )


def render_remainders(study: DiscoveryStudy) -> str:
    """Return the unexplained forces with their figures, or a note that there are none."""
    finding = study.finding
    if not finding.remains:
        more = 'other ' if finding.draught or finding.unexplained else ''
        text = f'No {more}unexplained force or moment exceeds the noise floor on any axis.'
        return f'{tables.render_unexplained(finding)}<p class="note">{text}</p>'
    return (
        tables.render_unexplained(finding)
        + tables.render_remainders(finding)
        + _render_latent_wrench(study)
    )


def _render_latent_wrench(study: DiscoveryStudy) -> str:
    """Return the figures of the unexplained force: over time, and against its terms."""
    flights, finding = collect_latent_wrenches(study), study.finding
    if not flights:
        return ''
    top = finding.remains[:3]
    rows = [
        [
            (each.name, colour, *join_pieces(each, AXES.index(one.axis)))
            for each, colour in zip(flights, (figures.AFTER, figures.BEFORE), strict=False)
        ]
        for one in top
    ]
    titles = [f'{one.axis} [{remainder_unit(one)}]' for one in top]
    names = join_words(
        [f'{word} {each.name}' for word, each in zip(('blue', 'orange'), flights, strict=False)]
    )
    section = render_section(
        'latent', 'The unexplained force over time',
        f'Estimated from the measured motion, not measured directly: {names}.',
        figures.plot_stacked_curves(rows, titles, 'time', 's'),
    )  # fmt: skip
    terms = flights[0].terms
    following = next((one for one in finding.remains if terms.keys() & set(one.follows)), None)
    if following is not None:
        axis, unit = AXES.index(following.axis), remainder_unit(following)
        section += render_section(
            'follows', f'What the unexplained force or moment ({following.axis}) varies with',
            f'{format_remainder(following).capitalize()}. These terms fully explain the points '
            'on the dashed line.',
            figures.plot_parity(
                fit_terms(flights, axis, following.follows),
                [
                    np.where(each.has_data, each.wrench[..., axis], np.nan).ravel()
                    for each in flights
                ],
                [each.name for each in flights],
                (f'{join_words(following.follows)}, fitted [{unit}]', f'{following.axis} '
                f'[{unit}]'),
            ),
        )  # fmt: skip
    return f'<div class="grid drawn">{section}</div>'


def list_provenance(finding: StudyResult) -> Mapping[str, str]:
    """Return the provenance of the page."""
    roles = {'train': 'learned from', 'confirm': 'confirmed by', 'holdout': 'held out'}
    return {
        'vehicle': finding.vehicle,
        **{
            words: join_words(finding.bags[role])
            for role, words in roles.items()
            if finding.bags.get(role)
        },
        'seed': str(finding.seed),
        **finding.versions,
    }


def list_commands(finding: StudyResult, folder: Path, bags: Bags) -> Mapping[str, str]:
    """Return the commands to repeat the study and to use its result."""
    words = ['--vehicle', finding.vehicle]
    for role in ('train', 'confirm', 'holdout'):
        if bags.get(role):
            words += [f'--{role}', *map(str, bags[role])]
    again = format_lta_command('discover', *words, '--seed', str(finding.seed))
    return {'do it again': again, **list_learned_file_commands(finding, folder)}
