"""lta cfd run: compute the aero file of a vehicle from its shape."""

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

from lta_cli.options.study_command import study_command, StudyRun
from lta_config.errors import unknown_name_error
from lta_config.schema.mount_file import load_mount
from lta_config.schema.tunnel_file import load_tunnel_file
from lta_report.report import Report
from lta_report.results_folder import resolve_folder
from lta_studies.cfd.progress import TunnelProgress
from lta_studies.cfd.report import build_report
from lta_studies.cfd.solvers import (
    Cache,
    check_solver_options,
    open_solver,
    refuse_solver_options,
    resolve_cache_folder,
)
from lta_windtunnel.flow_fields import FlowSlice, read_flow_slice
from lta_windtunnel.flow_plan import AIR, plan_flows, TunnelFlow
from lta_windtunnel.openfoam.case import CaseRunner
from lta_windtunnel.openfoam.programs import FoamPrograms
from lta_windtunnel.solve import build_sweep, solve_sweep
from lta_windtunnel.sweep_table import TunnelSweep
from lta_windtunnel.tunnel import INCIDENCES
from lta_windtunnel.tunnel_model import load_tunnel_model, TunnelModel
import typer

SHOWN = ('heave', 'surge', 'up_left', 'both_up', 'all', 'up_left_reversed', 'forward_left')


class Fidelity(StrEnum):
    """Solver fidelity: closed-form, steady or transient."""

    analytic = 'analytic'
    preview = 'preview'
    reference = 'reference'


@study_command('cfd', quick={'fidelity': Fidelity.analytic}, resumes=False)
def run(
    name: Annotated[
        str,
        typer.Argument(
            metavar='TUNNEL', help='Wind tunnel setup: a name in config/tunnels, or a file.'
        ),
    ] = 'gtmab',
    fidelity: Annotated[
        Fidelity,
        typer.Option(
            help='Method. analytic: formulas, without OpenFOAM. preview: OpenFOAM, steady flow. '
            'reference: OpenFOAM, transient flow.'
        ),
    ] = Fidelity.preview,
    only: Annotated[
        list[str] | None,
        typer.Option(
            help='Solve only this axis or rotor pattern, such as heave or both_up; repeat the '
            'option for several. incidence_10 to incidence_40 fly forward with the nose up by '
            'that many degrees, and are solved only if named.'
        ),
    ] = None,
    mount: Annotated[
        str | None,
        typer.Option(
            help='Add solar panels in this place: the name side, bottom or top of a shipped mount '
            'file, or a file of your own.'
        ),
    ] = None,
    cache: Cache = None,
    limit: Annotated[
        float | None,
        typer.Option('--memory', help='Memory limit in GB; all memory by default.', min=0.1),
    ] = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Compute a vehicle's drag along and about six axes, with rotors off and on.

    A tunnel file in config/tunnels defines the geometry: hull and rotors of a vehicle file,
    attached bodies, or STL files. OpenFOAM solves the cases in parallel. Solved cases are cached,
    so a stopped run resumes; failed cases are stored, too, and repeated with --retry-failed.
    --fidelity analytic needs no OpenFOAM; preview is steady and takes
    minutes; reference is transient and takes about an hour.

    Writes a page; NAME.sweep.json with all solutions; NAME.aero.yaml with the fitted coefficients,
    for the entry "aero: PATH" of a vehicle file; and, with rotors on, NAME.blown.json, the sweep
    with pressure maps.

    Exit status 0: done; failed cases are listed. 1: nothing could be solved. 2: bad input. 130:
    Ctrl-C.

    Example: lta cfd run gtmab --only heave --only both_up
    """
    file, _ = load_tunnel_file(name)
    model = load_tunnel_model(name, load_mount(mount) if mount else None)
    run.open_folder(resolve_folder(None, f'{model.name}-cfd'))
    flows: list[TunnelFlow] = []
    if fidelity is Fidelity.analytic:
        refuse_solver_options(run.options)
    else:
        check_solver_options(run.options)
        flows = select_flows(model, fidelity, only or ())
    if flows:
        with (
            TunnelProgress(run.console, flows) as bar,
            open_solver(flows, bar, run.options, cache, limit) as crew,
        ):
            solved_flows = solve_sweep(crew, model, flows, AIR, bar.show_message)
            sweep = build_sweep(
                model, file.vehicle, fidelity, AIR, *solved_flows, engine=crew.solver_version()
            )
    else:
        sweep = build_sweep(model, file.vehicle, fidelity, AIR, {}, {}, {})
    # The fields are in the cache folder; the sweep holds only coefficients and maps
    slices = slice_flows(model, sweep, flows, resolve_cache_folder(cache)) if run.page else []
    return build_report(sweep, slices)


def select_flows(model: TunnelModel, fidelity: str, only: Sequence[str]) -> list[TunnelFlow]:
    """Return the flows of some axes and patterns, or all; raise `BadInput` if one is unknown."""
    # Names of axes and patterns depend on the vehicle, so Typer cannot check them
    names = [*(flow.about for flow in plan_flows(model, fidelity, AIR)), *INCIDENCES]
    if strangers := [each for each in only if each not in names]:
        raise unknown_name_error('axis or pattern', strangers[0], names)
    return plan_flows(model, fidelity, AIR, only)


def slice_flows(
    model: TunnelModel, sweep: TunnelSweep, flows: list[TunnelFlow], folder: Path
) -> list[FlowSlice]:
    """Return slices through the most informative flows."""
    stages = CaseRunner(folder, FoamPrograms(), lambda *_: None)
    slices: list[FlowSlice] = []
    # False sorts before True: the flows of SHOWN come first, in their order
    for flow in sorted(flows, key=lambda each: each.about not in SHOWN):
        there = flow.about in sweep.blows or flow.about in sweep.axes
        # Flows that were solved, up to the number of pictures that a page can hold
        if there and len(slices) < len(SHOWN) and flow.kind in ('wind', 'blow'):
            piece = read_flow_slice(model, flow, stages.case_folder(flow.case))
            slices += [piece] if piece is not None else []
    return slices
