"""What `lta fly` and `lta simulate` print of a flight."""

from pathlib import Path

from lta_config.command_line import format_lta_command, relative_path
from lta_flight.flight_run import FlightRun
from lta_flight.report.outcome import describe_outcome
from lta_flight.report.results import FlightResults
from lta_report.results_folder import format_page_line
from rich.console import Console


def flight_to_dict(
    flight: FlightRun, figures: FlightResults | None, page: Path | None
) -> dict[str, object]:
    """Return the content of --json."""
    # Without results there is no page
    warned = {'warning': flight.warning} if flight.warning else {}
    pages = {} if page is None or figures is None else {'page': str(page)}
    return {
        'outcome': flight.outcome,
        'pace': flight.pace,
        'bag': str(flight.bag),
        **({} if figures is None else figures.to_dict()),
        **pages,
        **warned,
        'units': {'pace': '1', **({} if figures is None else figures.list_units())},
    }


def format_outcome(flight: FlightRun, figures: FlightResults | None) -> str:
    """Return the outcome in one sentence, and the warning of the flight, if any."""
    warning = f' {flight.warning}' if flight.warning else ''
    return f'{_format_verdict(flight, figures)}{warning}'


def _format_verdict(flight: FlightRun, figures: FlightResults | None) -> str:
    """Return the outcome in one sentence, from the page and the simulator's verdict."""
    # The bag has no goal to judge by, so the simulator's verdict counts
    on_course = flight.outcome == 'reached' and figures is not None and figures.success is None
    if figures is None or flight.outcome in {'failed', 'flown'} or on_course:
        return f'The drone {flight.sentence}.'
    if flight.outcome == 'reached':
        return f'{describe_outcome(figures)}.'
    return f'{describe_outcome(figures)}; it {flight.sentence}.'


def print_files(bag: Path, page: Path | None, console: Console) -> None:
    """Print the paths of the results and how to open them."""
    lines = [
        f'Bag  {bag}  (open it in Foxglove, or run: '
        f'{format_lta_command("bag", "info", relative_path(bag))})'
    ]
    if page is not None:
        lines.append(format_page_line(page))
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
