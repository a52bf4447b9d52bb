"""lta cfd validate: compare the drag of a sphere with measurements."""

from dataclasses import asdict
import sys
from typing import Annotated

from lta_cli.options.output_options import check_picture_output, Out, Pictures
from lta_cli.options.plain_console import plain_console
from lta_cli.options.worker_options import Scheduler, WorkerCount
from lta_cli.verbs.cfd.run import AIR, Fidelity
from lta_config.command_line import format_lta_command, relative_path
from lta_config.errors import BadInput
from lta_report.results_folder import (
    check_creatable,
    format_page_line,
    resolve_folder,
    stage_results,
    write_json,
)
from lta_report.screenshots import write_pictures
from lta_sim.cfd.validation import (
    build_sphere_model,
    compare_with_measurements,
    plan_validation_flows,
)
from lta_studies.cfd.progress import TunnelProgress
from lta_studies.cfd.solvers import Cache, check_solver_options, open_solver
from lta_studies.cfd.sphere_page import format_headline, write_page
from lta_studies.cfd.tables import build_sphere_table
from lta_studies.energy.tables import print_table
import typer


def validate(
    fidelity: Annotated[
        Fidelity,
        typer.Option(
            help='Flow solvers to validate. preview: only the steady solver. reference: also the '
            'transient solver.'
        ),
    ] = Fidelity.preview,
    workers: WorkerCount = None,
    cache: Cache = None,
    scheduler: Scheduler = None,
    out: Out = None,
    pictures: Pictures = None,
    json: Annotated[bool, typer.Option('--json', help='Print the results as JSON.')] = False,
) -> None:
    """
    Validate the wind tunnel: a 1 m sphere against Morrison's formula and Achenbach's scatter.

    The steady model is accurate at low speed. At high speed it underestimates drag, because its
    boundary layer turns turbulent too early and its wake does not shed. Two meshes show the
    effect of refinement. The transient model averages over 20 diameters of flow or more.

    Exit status 0: done, whatever the error. 1: nothing could be solved. 2: bad input. 130: Ctrl-C.

    Example: lta cfd validate --fidelity reference
    """
    console = plain_console(stderr=json)
    check_picture_output(pictures)
    if fidelity is Fidelity.analytic:
        raise BadInput(
            '--fidelity analytic solves no flow to validate; choose preview or reference.'
        )
    # Fail before any work if OpenFOAM or the scheduler is missing
    check_solver_options(workers, scheduler)
    target = resolve_folder(out, 'cfd-sphere')
    check_creatable(target)
    # The reference includes the preview, to show the effect of the model
    levels = ('preview',) if fidelity is Fidelity.preview else ('preview', 'reference')
    model = build_sphere_model()
    wanted = [flow for level in levels for flow in plan_validation_flows(model, level, AIR)]
    with (
        TunnelProgress(console, wanted) as bar,
        open_solver(wanted, bar, workers, cache, scheduler) as crew,
    ):
        found = compare_with_measurements(crew, model, wanted, AIR, bar.show_message)
    # Every case failed; the progress display has listed the reasons
    if not found:
        raise typer.Exit(1)
    with stage_results(target, 'report.html') as part:
        text = write_json([asdict(each) for each in found], part / 'sphere.json')
        again = format_lta_command('cfd', 'validate', '--fidelity', fidelity.value)
        write_page(found, {'Solve it again': again}, part / 'report.html')
    if pictures is not None:
        write_pictures(target / 'report.html', pictures)
    if json:
        sys.stdout.write(text)
    print_table(build_sphere_table(found), console)
    lines = [format_headline(found), format_page_line(relative_path(target / 'report.html'))]
    console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)
