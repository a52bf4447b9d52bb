"""lta platforms: the same manoeuvres, each platform by its own control law."""

from datetime import datetime
from pathlib import Path
import sys
from typing import Annotated

from lta_bridge.bag.writer import empty_folder
from lta_bridge.provenance import commit
from lta_cli.options.out_option import Out
from lta_cli.options.plain_console import plain_console
from lta_config.schema.comparison_file import load_comparison
from lta_config.typed import typed
from lta_report.browser import find_chromium
from lta_report.results_folder import keep_json, page_line, results_folder
from lta_report.screenshots import write_pictures
from lta_studies.platforms.page import Told, write_page
from lta_studies.platforms.run import check, fly_all, jobs, printed, processors, Row
from lta_studies.platforms.summary import reversals
from lta_studies.platforms.verdict import title
from rich.progress import track
import typer


def platforms(
    file: Annotated[
        str, typer.Argument(help='A shipped name (platforms) or a comparison file.')
    ] = 'platforms',
    seeds: Annotated[
        int | None, typer.Option(help='Flights of each; as the file says by default.', min=1)
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help='Processes; as many as processors by default.', min=1)
    ] = None,
    out: Out = None,
    pictures: Annotated[
        Path | None,
        typer.Option(help='Folder for each picture as PNG; needs a Chromium.', metavar='FOLDER'),
    ] = None,
    json: Annotated[bool, typer.Option('--json', help='Print every flight as JSON.')] = False,
) -> None:
    """
    Compare platforms: climb, turn, follow a heading, cruise; each by its own control law.

    A comparison file names contestants (vehicle, law, gains, what is set otherwise), ablations
    (one thing of a contestant changed, with the reason), and limits (ever more speed). A
    manoeuvre is a file of setpoints over time, with the band within which it counts as held.
    All is checked before the first flight.

    The results are flights.json, SI units, and a page: pictures, figures with their spread over
    the seeds, what each change turns, and each platform's static margin.

    Exit status 0: all was flown, whoever held. 2: bad input, nothing was flown. 130: Ctrl-C.

    Example: lta platforms --seeds 3
    """
    console = plain_console(stderr=json)
    if pictures is not None:
        find_chromium()  # says what is missing before anything flies
        empty_folder(pictures)
    comparison = load_comparison(file)
    check(file, comparison)
    todo = jobs(file, comparison, seeds or comparison.seeds)
    created = datetime.now().astimezone().isoformat(timespec='seconds')
    target = empty_folder(results_folder(out, comparison.name))
    coming = fly_all(todo, workers or processors())
    rows: list[Row] = list(
        track(coming, 'flying', len(todo), console=console, disable=not console.is_terminal)
    )
    order = {job: index for index, job in enumerate(todo)}
    rows.sort(key=lambda row: order[row.job])
    content = keep_json([printed(row) for row in rows], target / 'flights.json')
    origin = {
        'comparison': file, 'seeds': str(seeds or comparison.seeds), 'flights': str(len(rows)),
        'commit': commit(), 'created': created,
        'again': typed('platforms', file, '--seeds', str(seeds or comparison.seeds)),
    }  # fmt: skip
    page = write_page(Told(comparison, rows, target, origin))
    if pictures is not None:
        write_pictures(page, pictures)
    if json:
        sys.stdout.write(content)
    lines = [title(comparison, rows), *reversals(comparison, rows), page_line(page)]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
