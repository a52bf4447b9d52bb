# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What `lta cfd run` and `refit` take, and what they do in which order."""

from collections.abc import Sequence
from enum import StrEnum
import math
from pathlib import Path
import sys
from typing import Any, final

from lta_config.errors import BadInput, unknown_name_error
from lta_config.files import share_folder
from lta_config.machine import count_cores
from lta_config.schema.mount_file import load_mount
from lta_config.schema.vehicle_aero import load_tunnel_file
from lta_report.progress_bar import ProgressBar
from lta_report.report import Report
from lta_report.request import Action, argument, LocalStudyRequest, option, Outcome, StudyRun
from lta_report.results_folder import resolve_folder, write_file
from lta_report.study import StudyOptions
from lta_windtunnel.aero_text import format_aero_file
from lta_windtunnel.flow_fields import FlowSlice, read_flow_slice
from lta_windtunnel.flow_plan import plan_flows, TUNNEL_AIR, TunnelFlow
from lta_windtunnel.openfoam.case import (
    cache_folder,
    CaseRunner,
    FoamCase,
    ProgramStep,
    require_openfoam,
)
from lta_windtunnel.solve import (
    build_sweep,
    check_memory,
    machine_memory,
    solve_sweep,
    ThreadedFlowSolver,
)
from lta_windtunnel.sweep_table import read_sweep, TunnelSweep
from lta_windtunnel.tunnel import INCIDENCES
from lta_windtunnel.tunnel_model import load_tunnel_model, TunnelModel
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn

SLICED_FLOWS = ('heave', 'surge', 'up_left', 'both_up', 'all', 'up_left_reversed', 'forward_left')


class Fidelity(StrEnum):
    """Solver fidelity: closed-form, steady or transient."""

    analytic = 'analytic'
    preview = 'preview'
    reference = 'reference'


CACHE: Any = option(
    'Folder that stores solved flows, so that later runs reuse them.', default=None
)


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
    stages = CaseRunner(folder, lambda *_: None)
    slices: list[FlowSlice] = []
    # False sorts before True: the flows of SHOWN come first, in their order
    for flow in sorted(flows, key=lambda each: each.about not in SLICED_FLOWS):
        there = flow.about in sweep.blows or flow.about in sweep.axes
        # Flows that were solved, up to the number of pictures that a page can hold
        if there and len(slices) < len(SLICED_FLOWS) and flow.kind in ('wind', 'blow'):
            piece = read_flow_slice(model, flow, stages.case_folder(flow.case))
            slices += [piece] if piece is not None else []
    return slices


def list_cases(flows: Sequence[TunnelFlow]) -> list[FoamCase]:
    """Return the unique cases of some flows, meshes first."""
    meshes = [flow.case.mesh for flow in flows if flow.case.mesh is not None]
    unique = {case.key: case for case in [*meshes, *(flow.case for flow in flows)]}
    return list(unique.values())


@final
class TunnelProgress(ProgressBar):
    """
    Progress bar of a sweep.

    The time left is extrapolated from the pace of the last ten minutes, so that it includes the
    load of other programs.
    """

    def __init__(self, console: Console, flows: Sequence[TunnelFlow]) -> None:
        columns = (
            TextColumn('{task.description}'),
            BarColumn(),
            TimeRemainingColumn(),
        )
        self._cases = list_cases(flows)
        # A bar with a total of 0 would never complete.
        work = sum(case.work for case in self._cases) or 1.0
        super().__init__(console, *columns, begin='meshes', total=work, period=600.0)
        self._done: dict[str, float] = {}
        self._telling: dict[str, str] = {}

    def skip_solved(self, stages: CaseRunner) -> None:
        """Exclude cases that are already solved."""
        self._cases = [case for case in self._cases if not stages.is_done(case)]
        self.update_bar(total=sum(case.work for case in self._cases) or 1.0)

    def update_case_progress(
        self, case: FoamCase, step: ProgramStep, share: float, residual: float
    ) -> None:
        """Update the progress of a case."""
        # Programs without iterations count as 20 rounds, so that they advance the bar too.
        rounds = [max(each.rounds, 20) for each in case.steps]
        before = sum(rounds[: list(case.steps).index(step)])
        done = (before + share * rounds[list(case.steps).index(step)]) / sum(rounds)
        self._done[case.key] = done * case.work
        suffix = '' if math.isnan(residual) else f' {residual:.0e}'
        self._telling[case.key] = f'{case.name} {100 * done:.0f} %{suffix}'
        if done >= 1.0:
            del self._telling[case.key]
        # Three running cases fit on a line.
        words = ', '.join(list(self._telling.values())[:3])
        self.update_bar(completed=sum(self._done.values()), description=words)


def refuse_solver_options(options: StudyOptions) -> None:
    """Raise `BadInput` for options of a solver where none runs."""
    if options != StudyOptions():
        raise BadInput(
            '--fidelity analytic solves no flow; leave --workers and --retry-failed out, or '
            'choose the fidelity preview or reference.'
        )


def open_solver(
    flows: Sequence[TunnelFlow], bar: TunnelProgress, options: StudyOptions, cache: Path | None,
    limit: float | None = None,
) -> ThreadedFlowSolver:  # fmt: skip
    """
    Return the solver for some flows; raise `BadInput` if their meshes do not fit in memory.

    Parameters
    ----------
    flows : sequence of TunnelFlow
        All flows of the command.
    options : StudyOptions
        Flows at a time; whether to repeat failures.
    cache : Path, optional
        Cache folder of solved flows.
    limit : float, optional
        Memory of this machine. [GB]

    """
    tell, retry = bar.update_case_progress, options.retry_failed
    folder, side_by_side = resolve_cache_folder(cache), options.workers or count_cores()
    # The limit is an option in GB; memory is counted in bytes.
    check_memory(flows, side_by_side, 1e9 * limit if limit else machine_memory())
    bar.skip_solved(CaseRunner(folder, tell))
    return ThreadedFlowSolver(folder, side_by_side, tell, retry)


def resolve_cache_folder(cache: Path | None) -> Path:
    """Return the cache folder of this machine."""
    return (cache or cache_folder()).absolute()
