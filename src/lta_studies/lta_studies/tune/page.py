"""Write the report of a tuning as one self-contained HTML file."""

from collections.abc import Sequence
from html import escape
import math
from pathlib import Path
from typing import Final

from lta_bridge.provenance import read_commit
from lta_config.command_line import format_lta_command, relative_path
from lta_report.formatting import format_number, Tile
from lta_report.html_elements import render_section, render_tile
from lta_report.page_frame import assemble_page, write_file
from lta_studies.tune import pictures, report_tables
from lta_studies.tune.run import TuningResult, vehicle_name
from lta_studies.tune.step_response import Channel, StepResponse

NAME = 'report.html'
CHANNELS: Final[tuple[tuple[Channel, str, str], ...]] = (
    (
        'altitude',
        'Climb and descent',
        'If no rotor reverses, only the weight pulls the drone down.',
    ),
    ('heading', 'Turn', 'Without airspeed.'),
    ('speed', 'Forward speed', 'Some speed remains from the turn before.'),
    (
        'course',
        'Turn at speed',
        'Course: direction of motion through the air; the nose points against the drift.',
    ),
)
SEARCH: Final = (
    'Lowest cost so far: average of the mean and the worst cost of the test flights. '
    'Dotted: the old gains.'
)
Traces = Sequence[tuple[float, StepResponse]]


def write_page(tuned: TuningResult, old: Traces, new: Traces) -> Path:
    """Write the page and return its path; raise `BadInput` if that fails."""
    return write_file(render_page(tuned, old, new), tuned.folder / NAME)


def render_page(tuned: TuningResult, old: Traces, new: Traces) -> str:
    """Return the HTML of the page."""
    order = tuned.order
    robust = report_tables.render_table(ROBUST_HEADS, report_tables.build_comparison_rows(tuned))
    margins = report_tables.render_table(
        report_tables.MARGIN_HEADS, report_tables.build_stability_margin_rows(tuned), text=True
    )
    limits = report_tables.render_table(
        ('', 'old', 'new'), report_tables.build_helium_limit_rows(tuned.old.limit, tuned.new.limit)
    )
    return assemble_page(
        'tune.html',
        title=escape(report_tables.typeset_signs(report_tables.format_headline(tuned))),
        kicker=escape(f'tune {vehicle_name(order)} · from {tuned.gains_name} · seed {order.seed}'),
        about=escape(describe_tuning(tuned)),
        tiles='\n'.join(render_tile(*each) for each in build_tiles(tuned)),
        panels='\n'.join(render_plot_sections(tuned, old, new)),
        robust=robust,
        margins=margins + MARGINS_NOTE,
        gains=report_tables.render_table(
            ('number', 'old', 'new', 'searched'), report_tables.build_parameter_rows(tuned)
        ),
        limits=limits + LIMITS_NOTE,
        facts=build_provenance_table(tuned),
        commands=suggest_commands(tuned),
        files={'Gains file': tuned.file.read_text(encoding='utf-8')},
    )


def describe_tuning(tuned: TuningResult) -> str:
    """Describe the flights of the tuning and the cost."""
    order = tuned.order
    return (
        f'{len(tuned.found.history)} candidate gain sets flew {len(tuned.losses)} test '
        f'flights each, with {1e3 * order.least:g} to {1e3 * order.most:g} g of lift lost, '
        'unknown to the drone. The comparison below uses new random flights. The cost '
        'combines settling, overshoot, steady error, swing, rotor activity and mission '
        'time; lower is better.'
    )


ROBUST_HEADS = ('median (quartiles), or share (95 % interval)', 'old', 'new')
MARGINS_NOTE = (
    '<p class="note">Each loop is opened at its demand with the others closed, using one control '
    'period linearised about the steady flight. Gain: by how much it may fall or rise before the '
    'loop oscillates. Phase and delay: margins at the crossover. Where a swing grows, the '
    'drone is unstable whatever the margins of a single loop.</p>'
)
LIMITS_NOTE = (
    '<p class="note">Relative to the trim of the vehicle file. Held: take-off, a climb of 0.4 m '
    'and a descent, each ending within 0.3 m of the altitude. Days follow from the permeation of '
    'laminates, assumed for this film.</p>'
)


def build_tiles(tuned: TuningResult) -> list[Tile]:
    """Return the tiles with the key figures."""
    old, new = tuned.old, tuned.new

    def both(name: str, words: str, unit: str, factor: float, digits: int) -> Tile:
        a, b = (side.flights.compute_metric_quartiles(name).median * factor for side in (old, new))
        return Tile(words, f'{b:.{digits}f}', unit, f'median; before {a:.{digits}f}')

    # Overshoot of one step with old and new gains [%]
    def over(step: int) -> tuple[float, float]:
        a, b = (100 * side.flights.summarize_step(step, 'overshoot').median for side in (old, new))
        return a, b

    # Step 0 is the climb.
    climb = over(0)
    held = new.limit.grams
    return [
        both('cost', 'Cost', '', 1.0, 3),
        Tile('Overshoot of a climb', f'{climb[1]:.0f}', '%', f'median; before {climb[0]:.0f}'),
        both('swing', 'Swing at the end', '\N{DEGREE SIGN}', 180.0 / math.pi, 2),
        Tile(
            'Missions at the goal',
            f'{100 * new.flights.reached_share.value:.0f}',
            '%',
            f'before {report_tables.format_share(old.flights.reached_share)}',
        ),
        Tile(
            'Holds up to',
            format_number(held, 1),
            'g lost',
            f'after {new.limit.days[0]:.0f} to {new.limit.days[1]:.0f} days of leaking',
        ),
        Tile(
            'Flights',
            str(len(tuned.found.history) * len(tuned.losses)),
            '',
            # Each draw is flown with both sets of gains.
            f'in the search, and {2 * len(old.flights.reports)} in the comparison',
        ),
    ]


def render_plot_sections(tuned: TuningResult, old: Traces, new: Traces) -> list[str]:
    """Return the sections with the plots."""
    lines = (
        'True values, one line for each loss of lift; the paler, the larger the loss. '
        'Dotted: setpoint.'
    )
    out = [
        render_section(
            channel, heading, f'{caption} {lines}', pictures.plot_responses(channel, old, new)
        )
        for channel, heading, caption in CHANNELS
    ]
    flights = tuned.old.flights, tuned.new.flights
    history = pictures.plot_search(tuned.found.history, len(tuned.losses))
    every = 'Each random flight is flown with both sets of gains.'
    return [
        *out,
        render_section(
            'costs', 'Cost of each new random flight', every, pictures.plot_costs(*flights)
        ),
        render_section(
            'search',
            'The search',
            SEARCH,
            history,
        ),
    ]


def build_provenance_table(tuned: TuningResult) -> dict[str, str]:
    """Return the provenance table of the page."""
    order = tuned.order
    return {
        'vehicle': order.vehicle,
        'gains before': tuned.gains_name,
        'losses in the search': ', '.join(f'{1e3 * loss:.2g} g' for loss in tuned.losses),
        # 1000 is `compare.FRESH`.
        'seeds': f'{order.seed} to {order.seed + len(tuned.losses) - 1} in the search, '
        'from 1000 in the comparison',
        'commit': read_commit(),
    }


def suggest_commands(tuned: TuningResult) -> dict[str, str]:
    """Return commands for the next steps."""
    file = str(relative_path(tuned.file))
    return {
        'Fly with the new gains': format_lta_command(
            'simulate', '--vehicle', tuned.order.vehicle, '--gains', file
        ),
        'Continue tuning from them': format_lta_command(
            'tune', tuned.order.vehicle, '--gains', file
        ),
    }
