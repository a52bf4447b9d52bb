"""What `lta cfd run` and `refit` take, and what they do in which order."""

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
import sys
from typing import final

from lta_config.errors import unknown_name_error
from lta_config.files import share_folder
from lta_config.schema.mount_file import load_mount
from lta_config.schema.vehicle_aero import load_tunnel_file
from lta_report.report import Report
from lta_report.request import Action, argument, LocalStudyRequest, option, Outcome, StudyRun
from lta_report.results_folder import resolve_folder, write_file
from lta_studies.cfd.progress import (
    CACHE,
    open_solver,
    refuse_solver_options,
    resolve_cache_folder,
    TunnelProgress,
)
from lta_windtunnel.aero_text import format_aero_file
from lta_windtunnel.flow_fields import FlowSlice, read_flow_slice
from lta_windtunnel.flow_plan import plan_flows, TUNNEL_AIR, TunnelFlow
from lta_windtunnel.openfoam.case import CaseRunner, FoamPrograms, require_openfoam
from lta_windtunnel.solve import build_sweep, solve_sweep
from lta_windtunnel.sweep_table import read_sweep, TunnelSweep
from lta_windtunnel.tunnel import INCIDENCES
from lta_windtunnel.tunnel_model import load_tunnel_model, TunnelModel
from rich.console import Console

SLICED_FLOWS = ('heave', 'surge', 'up_left', 'both_up', 'all', 'up_left_reversed', 'forward_left')


class Fidelity(StrEnum):
    """Solver fidelity: closed-form, steady or transient."""

    analytic = 'analytic'
    preview = 'preview'
    reference = 'reference'


@final
class TunnelRequest(
    LocalStudyRequest, command='cfd run', folder='cfd', quick={'fidelity': Fidelity.analytic},
    resumes=False,
):  # fmt: skip
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

    name: str = argument(
        'Wind tunnel setup: a name in config/tunnels, or a file.', default='gtmab',
        metavar='TUNNEL',
    )  # fmt: skip
    fidelity: Fidelity = option(
        'Method. analytic: formulas, without OpenFOAM. preview: OpenFOAM, steady flow. reference: '
        'OpenFOAM, transient flow.',
        default=Fidelity.preview,
    )
    only: tuple[str, ...] = option(
        'Solve only this axis or rotor pattern, such as heave or both_up; repeat the option for '
        'several. incidence_10 to incidence_40 fly forward with the nose up by that many degrees, '
        'and are solved only if named.',
        default=(),
    )
    mount: str | None = option(
        'Add solar panels in this place: the name side, bottom or top of a shipped mount file, or '
        'a file of your own.',
        default=None,
    )
    cache: Path | None = CACHE
    limit: float | None = option(
        'Memory limit in GB; all memory by default.', default=None, low=0.1, name='memory'
    )

    def run(self, run: StudyRun) -> Report:
        """Return the report of all axes and rotor patterns."""
        from lta_studies.cfd.report import build_report

        file, _ = load_tunnel_file(self.name)
        model = load_tunnel_model(self.name, load_mount(self.mount) if self.mount else None)
        run.open_folder(resolve_folder(None, f'{model.name}-cfd'))
        flows: list[TunnelFlow] = []
        if self.fidelity is Fidelity.analytic:
            refuse_solver_options(run.options)
        else:
            require_openfoam()
            flows = select_flows(model, self.fidelity, self.only)
        if flows:
            with TunnelProgress(run.console, flows) as bar:
                solver = open_solver(flows, bar, run.options, self.cache, self.limit)
                solved_flows = solve_sweep(solver, model, flows, TUNNEL_AIR, bar.show_message)
                sweep = build_sweep(
                    model, file.vehicle, self.fidelity, TUNNEL_AIR, *solved_flows,
                    engine=solver.solver_version(),
                )  # fmt: skip
        else:
            sweep = build_sweep(model, file.vehicle, self.fidelity, TUNNEL_AIR, {}, {}, {})
        # The fields are in the cache folder; the sweep holds only coefficients and maps
        cache = resolve_cache_folder(self.cache)
        slices = slice_flows(model, sweep, flows, cache) if self.page else []
        return build_report(sweep, slices)


@final
class RefitRequest(Action, command='cfd refit'):
    """
    Refit the coefficients of a sweep that "lta cfd run" wrote, without solving anything.

    Exit status 0: done. 2: bad input.

    Example: lta cfd refit gtmab
    """

    sweep: str = argument(
        'CFD results to fit: a .sweep.json file, or the name of one in config/aero.',
        metavar='SWEEP',
    )
    file: Path | None = option(
        'Aero file to write; printed by default.', default=None, metavar='FILE'
    )

    def run(self, console: Console) -> Outcome[str]:
        """Print or write the aero file, and return its text."""
        path = Path(self.sweep)
        # A plain word is a shipped name, anything else a path
        if '/' not in self.sweep and not self.sweep.endswith('.json'):
            path = share_folder() / 'aero' / f'{self.sweep}.sweep.json'
        text = format_aero_file(read_sweep(path))
        if self.file is None:
            sys.stdout.write(text)
        else:
            write_file(text, self.file)
        return Outcome(text)


def select_flows(model: TunnelModel, fidelity: str, only: Sequence[str]) -> list[TunnelFlow]:
    """Return the flows of some axes and patterns, or all; raise `BadInput` if one is unknown."""
    # Names of axes and patterns depend on the vehicle, so Typer cannot check them
    names = [*(flow.about for flow in plan_flows(model, fidelity, TUNNEL_AIR)), *INCIDENCES]
    if strangers := [each for each in only if each not in names]:
        raise unknown_name_error('axis or pattern', strangers[0], names)
    return plan_flows(model, fidelity, TUNNEL_AIR, only)


def slice_flows(
    model: TunnelModel, sweep: TunnelSweep, flows: list[TunnelFlow], folder: Path
) -> list[FlowSlice]:
    """Return slices through the most informative flows."""
    stages = CaseRunner(folder, FoamPrograms(), lambda *_: None)
    slices: list[FlowSlice] = []
    # False sorts before True: the flows of SHOWN come first, in their order
    for flow in sorted(flows, key=lambda each: each.about not in SLICED_FLOWS):
        there = flow.about in sweep.blows or flow.about in sweep.axes
        # Flows that were solved, up to the number of pictures that a page can hold
        if there and len(slices) < len(SLICED_FLOWS) and flow.kind in ('wind', 'blow'):
            piece = read_flow_slice(model, flow, stages.case_folder(flow.case))
            slices += [piece] if piece is not None else []
    return slices
