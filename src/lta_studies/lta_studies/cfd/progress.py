"""Show the progress of flows in a wind tunnel, and open their solver."""

from collections.abc import Sequence
import math
from pathlib import Path
from typing import Any, final

from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.progress_bar import ProgressBar
from lta_report.request import option
from lta_report.study import StudyOptions
from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.openfoam.case import (
    cache_folder,
    CaseRunner,
    FoamCase,
    FoamPrograms,
    ProgramStep,
)
from lta_windtunnel.solve import check_memory, machine_memory, ThreadedFlowSolver
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn


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


CACHE: Any = option(
    'Folder that stores solved flows, so that later runs reuse them.', default=None
)


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
    bar.skip_solved(CaseRunner(folder, FoamPrograms(), tell))
    return ThreadedFlowSolver(folder, side_by_side, tell, retry)


def resolve_cache_folder(cache: Path | None) -> Path:
    """Return the cache folder of this machine."""
    return (cache or cache_folder()).absolute()
