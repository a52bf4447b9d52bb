"""Word and draw the law of a study: terms, region, errors, and its agreement with the flights."""

from html import escape
from typing import Final

from lta_config.schema.vehicle_law import AXES as LAW_AXES
from lta_config.schema.vehicle_law import QUANTITIES
from lta_discovery.conclusion import FAR
from lta_discovery.finding import ChannelErrors, FittedTolerance, LawFinding, StudyResult
from lta_discovery.laws.forecast import FlightLaw
from lta_discovery.laws.quantities import at_pieces, input_quantities, state_quantities
from lta_discovery.page import figures
from lta_discovery.page.flight_views import list_fit_flights
from lta_discovery.page.formatting import (
    append_unit,
    format_number,
    format_quantity,
    format_with_interval,
    join_words,
)
from lta_discovery.page.latent_wrench import collect_latent_wrenches, join_pieces
from lta_discovery.page.tables import render_table
from lta_discovery.replay.linearized_flight import AXES
from lta_discovery.replay.replay import STEPS
from lta_discovery.study import DiscoveryStudy
from lta_model.effects.protocol import AXES as BODY
from lta_model.law_arrays import HIDDEN_QUANTITIES
from lta_model.law_text import describe_term, format_hidden, format_product, format_region
from lta_report.formatting import format_count
from lta_report.html_elements import render_section
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LISTED: Final = 3  # tolerances in the sentence; the table has all
CHANGED: Final = ('value', 'change from the vehicle file', 'standard deviations of its tolerance')
HEADS: Final = ('axis', 'times', 'coefficient', '95 % interval', 'evidence')


def list_law_sentences(finding: StudyResult) -> list[str]:
    """Return the law in words, its errors and the nearest effects; empty if none was sought."""
    law = finding.law
    if law is None:
        return []
    near = (
        f' The nearest effects of the library were rejected: {"; ".join(law.near)}.'
        if law.near
        else ''
    )
    if law.law is None:
        return [f'No law is proposed for it: {law.reason}.{near}']
    terms = join_words([describe_term(term) for term in law.law.terms])
    hidden = f', where {format_hidden(law.law)}' if law.law.hidden else ''
    return [
        f'A law describes it: {terms}{hidden}.',
        f'On held-out flights, after {FAR:g} s, {_format_errors(law)}.{near}',
        f'It is valid for {format_region(law.law)}; outside, it fades to zero.',
        *_list_tolerance_sentences(law),
    ]


def _list_tolerance_sentences(outcome: LawFinding) -> list[str]:
    """Return which values of the file were fitted together with a law; empty if none was."""
    if not outcome.tolerances:
        return []
    first = [
        f'{one.name} by {_format_change(one)} ({one.deviations:+.1f} standard deviations)'
        for one in outcome.tolerances[:LISTED]
    ]
    rest = len(outcome.tolerances) - len(first)
    more = [format_count(rest, 'other')] if rest else []
    return [
        'It belongs to the tolerances that were fitted together with it, which vehicle.yaml '
        f'therefore holds as well, with their source: {join_words([*first, *more])}.'
    ]


def _format_change(one: FittedTolerance) -> str:
    """Return the change of a value of the file with its sign; relative ones in percent."""
    if one.unit == '1':
        return f'{100.0 * one.change:+.2g} %'
    return f'{one.change:+.3g} {one.unit}'


def _format_errors(outcome: LawFinding) -> str:
    """Return the errors of position and attitude with the law and without."""
    return join_words([_format_error(one) for one in outcome.errors if one.horizon_s == FAR])


def _format_error(one: ChannelErrors) -> str:
    """Return the error of a channel with the law and without."""
    after, before = (format_quantity(part, one.unit, 2) for part in (one.after, one.tuned))
    return f'the {one.channel} error is {after} with it and {before} without'


def render_law(study: DiscoveryStudy) -> str:
    """Return the section of the law; '' if none was sought."""
    law = study.finding.law
    if law is None:
        return ''
    items = ''.join(f'<li>{escape(one)}</li>' for one in list_law_sentences(study.finding))
    text = f'<ul class="words">{items}</ul>'
    if law.law is None:
        return text
    rows = []
    for term in law.law.terms:
        ends = (term.interval or [np.nan, np.nan])[:2]
        value, low, high = format_with_interval(term.coefficient, (ends[0], ends[1]))
        rows.append(
            (
                escape(term.axis.replace('_', ' ')),
                escape(format_product(law.law, term.factors) or '1'),
                escape(append_unit(value, term.unit)),
                f'{low} to {high}',
                f'{format_number(term.evidence or 0.0)} nats',
            )
        )
    table = render_table(HEADS, rows, 'plain law', 'Terms of the law')
    return text + table + _render_tolerances(law) + _render_figures(study, law)


def _render_tolerances(outcome: LawFinding) -> str:
    """Return the table of the values that were fitted together with a law; '' without any."""
    rows = [
        (escape(one.name), escape(_format_change(one)), f'{one.deviations:+.2f}')
        for one in outcome.tolerances
    ]
    title = 'Values of the file that were fitted together with the law'
    return render_table(CHANGED, rows, 'plain', title) if rows else ''


def _render_figures(study: DiscoveryStudy, outcome: LawFinding) -> str:
    """Return the law beside the unexplained force: over time, and over its main quantity."""
    law, flights = outcome.law, collect_latent_wrenches(study)
    if law is None or not flights:
        return ''
    main = max(law.terms, key=lambda term: term.evidence or 0.0)
    # A force along an axis of the map is shown on the axis of the body nearest to it
    name = {'map_x': 'surge', 'map_y': 'sway', 'map_z': 'heave'}.get(main.axis, main.axis)
    axis, unit = BODY.index(name), LAW_AXES[main.axis]
    quantity = main.factors[0].quantity if main.factors else 'time'
    quantity = 'time' if quantity in HIDDEN_QUANTITIES else quantity
    chosen = {
        study_flight.role: (study_flight, fit)
        for study_flight, fit in reversed(list_fit_flights(study))
    }
    curves, over, points = [], [], []
    for each, (study_flight, fit) in zip(
        flights, (chosen[role] for role in ('train', 'confirm') if role in chosen), strict=False
    ):
        point, flight = fit.linear.point, study_flight.flight
        states = flight.simulate_trajectory(point)
        force = FlightLaw(law, flight, point.nominal).compute_wrench(states)[..., axis]
        seen = state_quantities(states[:, :-1:STEPS]) | at_pieces(
            flight, input_quantities(flight, point.nominal)
        )
        knots = each.time.shape[1]
        at = np.rint(np.linspace(0, force.shape[1] - 1, knots)).astype(int)
        wrench = np.zeros((*each.time.shape, AXES))
        wrench[..., axis] = force[:, at]
        curves.append(
            [
                ('estimated from the flight', figures.AFTER, *join_pieces(each, axis)),
                ('law', figures.BEFORE, *join_pieces(each._replace(wrench=wrench), axis)),
            ]
        )
        over.append(np.where(each.has_data, seen[quantity][:, at // STEPS], np.nan).ravel())
        points.append((each.wrench[..., axis].ravel(), wrench[..., axis].ravel()))
    names = [each.name for each in flights]
    titles = [f'{name}, {each} [{unit}]' for each in names]
    return (
        '<div class="grid drawn">'
        + render_section(
            'lawtime', 'The law over time',
            'Blue: the unexplained force or moment, estimated from the measured motion without '
            'the law; orange: the law.',
            figures.plot_stacked_curves(curves, titles, 'time', 's'),
        )
        + render_section(
            'lawover', f'The law over {quantity.replace("_", " ")}',
            'Each point is a moment of a flight: the unexplained force or moment, and the law.',
            figures.plot_points(
                [x for x in over for _ in range(2)],
                [part for pair in points for part in pair],
                [word for each in names for word in (each, f'{each}, law')],
                (f'{quantity.replace("_", " ")} [{QUANTITIES[quantity]}]', f'{name} [{unit}]'),
            ),
        )
        + '</div>'
    )  # fmt: skip
