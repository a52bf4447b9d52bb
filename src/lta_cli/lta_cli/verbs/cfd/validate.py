"""lta cfd validate: compare the drag of a sphere with measurements."""

from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_cli.verbs.cfd.run import Fidelity
from lta_config.errors import BadInput
from lta_report.report import Report
from lta_studies.cfd.progress import TunnelProgress
from lta_studies.cfd.solvers import Cache, check_solver_options, open_solver
from lta_studies.cfd.sphere_report import build_report
from lta_windtunnel.flow_plan import AIR
from lta_windtunnel.validation import (
    build_sphere_model,
    compare_with_measurements,
    plan_validation_flows,
)
import typer


@study_command(
    'cfd-sphere', quick='Solve only the coarser of the two steady meshes.', resumes=False
)
def validate(
    fidelity: Annotated[
        Fidelity,
        typer.Option(
            help='Flow solvers to validate. preview: only the steady solver. reference: also the '
            'transient solver.'
        ),
    ] = Fidelity.preview,
    cache: Cache = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Validate the wind tunnel: a 1 m sphere against Morrison's formula and Achenbach's scatter.

    The steady model is accurate at low speed. At high speed it underestimates drag, because its
    boundary layer turns turbulent too early and its wake does not shed. Two meshes show the
    effect of refinement. The transient model averages over 20 diameters of flow or more.

    Exit status 0: done, whatever the error. 1: nothing could be solved. 2: bad input. 130: Ctrl-C.

    Example: lta cfd validate --fidelity reference
    """
    if fidelity is Fidelity.analytic:
        raise BadInput(
            '--fidelity analytic solves no flow to validate; choose preview or reference.'
        )
    # Fail before any work if OpenFOAM or the scheduler is missing
    check_solver_options(run.options)
    # The reference includes the preview, to show the effect of the model
    levels = ('preview',) if fidelity is Fidelity.preview else ('preview', 'reference')
    model = build_sphere_model()
    flows = [flow for level in levels for flow in plan_validation_flows(model, level, AIR)]
    if run.quick:
        flows = [min(flows, key=lambda flow: flow.case.cells)]
    with (
        TunnelProgress(run.console, flows) as bar,
        open_solver(flows, bar, run.options, cache) as crew,
    ):
        results = compare_with_measurements(crew, model, flows, AIR, bar.show_message)
    # Every case failed; the progress display has listed the reasons
    if not results:
        raise typer.Exit(1)
    count = sum(len(flow.speeds) for flow in flows)
    return build_report(results, count)
