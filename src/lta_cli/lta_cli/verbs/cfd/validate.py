"""lta cfd validate: the tunnel's sphere beside real ones."""

from dataclasses import asdict
import sys
from typing import Annotated

from lta_cli.options.out_option import Out
from lta_cli.options.pictures_option import can_be_taken, Pictures
from lta_cli.options.plain_console import plain_console
from lta_cli.verbs.cfd.run import AIR, Fidelity
from lta_config.errors import BadInput
from lta_config.typed import near, typed
from lta_report.results_folder import (
    all_at_once,
    can_be_made,
    keep_json,
    page_line,
    results_folder,
)
from lta_report.screenshots import write_pictures
from lta_sim.cfd.validation import flows, judge, sphere
from lta_studies.cfd.crews import Cache, can_solve, crew_for, Jobs, Scheduler
from lta_studies.cfd.progress import TunnelProgress
from lta_studies.cfd.sphere_page import title, write_page
from lta_studies.cfd.tables import spheres
from lta_studies.energy.tables import show
import typer


def validate(
    fidelity: Annotated[
        Fidelity, typer.Option(help='preview, or reference, which solves preview too.')
    ] = Fidelity.preview,
    jobs: Jobs = None,
    cache: Cache = None,
    scheduler: Scheduler = None,
    out: Out = None,
    pictures: Pictures = None,
    json: Annotated[bool, typer.Option('--json', help='Print the results as JSON.')] = False,
) -> None:
    """
    Judge the wind tunnel by a sphere of 1 m, beside Morrison's formula and Achenbach's scatter.

    The steady model is right at slow speeds and low at fast ones, where its boundary layer is
    turbulent too early and its wake does not shed; two meshes show what finer ones change. The
    transient one averages 20 diameters of flow or more.

    Exit status 0: done, however far off. 1: nothing could be solved. 2: bad input. 130: Ctrl-C.

    Example: lta cfd validate --fidelity reference
    """
    console = plain_console(stderr=json)
    can_be_taken(pictures)
    if fidelity is Fidelity.analytic:
        raise BadInput('A sphere by hand is the measurement itself; take preview or reference.')
    can_solve(jobs, scheduler)
    target = results_folder(out, 'cfd-sphere')
    can_be_made(target)
    levels = ('preview',) if fidelity is Fidelity.preview else ('preview', 'reference')
    model = sphere()
    wanted = [flow for level in levels for flow in flows(model, level, AIR)]
    with (
        TunnelProgress(console, wanted) as bar,
        crew_for(wanted, bar, jobs, cache, scheduler) as crew,
    ):
        found = judge(crew, model, wanted, AIR, bar.say)
    if not found:
        raise typer.Exit(1)
    with all_at_once(target, 'report.html') as part:
        text = keep_json([asdict(each) for each in found], part / 'sphere.json')
        again = typed('cfd', 'validate', '--fidelity', fidelity.value)
        write_page(found, {'Solve it again': again}, part / 'report.html')
    if pictures is not None:
        write_pictures(target / 'report.html', pictures)
    if json:
        sys.stdout.write(text)
    show(spheres(found), console)
    lines = [title(found), page_line(near(target / 'report.html'))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
