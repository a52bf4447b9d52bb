"""
Solve the flows of a wind tunnel on a Dask cluster.

Its machines need LTA and OpenFOAM. A flow is solved and evaluated on one worker, and only the
numbers are returned. Each machine caches its solved cases; a shared folder (--cache) avoids
computing a mesh more than once.
"""

from collections.abc import Generator, Sequence
from contextlib import closing
from functools import partial
import math
from pathlib import Path
from typing import Any, Final, final

from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.cluster import connect_cluster
from lta_report.progress_bar import ProgressBar
from lta_report.request import option
from lta_report.study import StudyOptions
from lta_report.workers import DaskWorkers, ItemFailure
from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.flow_solvers import (
    FlowSolver,
    Found,
    list_distinct_meshes,
    solve_flow,
    solve_mesh,
    ThreadedFlowSolver,
)
from lta_windtunnel.openfoam.case import cache_folder, CaseRunner, FoamCase, ProgramStep, Progress
from lta_windtunnel.openfoam.programs import (
    CaseFailed,
    find_openfoam_version,
    FoamPrograms,
    has_openfoam,
    require_openfoam,
)
from lta_windtunnel.solve import check_memory, machine_memory
from lta_windtunnel.tunnel_model import TunnelModel
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


MEMORY_REMEDY: Final = (
    'start its workers with fewer threads or more memory, or use a coarser --fidelity'
)

CasePlace = tuple[Path | None, bool]  # cache of cases, and whether to repeat failed ones


@final
class DaskFlowSolver:
    """
    Workers of a Dask cluster; each thread solves one flow.

    `address`: address of the scheduler, such as tcp://10.0.0.1:8786. `place`: cache of solved
    cases on every machine, by default the machine's own. `engine`: versions of OpenFOAM. `tell`:
    progress callback for solved cases.
    """

    def __init__(self, address: str, place: CasePlace, engine: str, tell: Progress) -> None:
        self._address, self._place, self._engine, self._tell = address, place, engine, tell

    def solver_version(self) -> str:
        """Return the OpenFOAM versions of the workers."""
        return self._engine

    def solve_flows(
        self, model: TunnelModel, flows: Sequence[TunnelFlow], density: float
    ) -> Generator[tuple[TunnelFlow, Found | CaseFailed]]:
        """Yield each flow with its result or failure; parameters as in `solve_flow`."""
        outcomes: dict[int, Found | ItemFailure] = {}
        work = partial(solve_on_worker, self._place, model, density)
        with DaskWorkers(work, self._address) as workers:
            # All meshes before the flows that share them; a failed one fails its flows again
            for mesh, _ in workers.run(list_distinct_meshes(flows)):
                self._tell(mesh, mesh.steps[-1], 1.0, math.nan)
            for flow, outcome in workers.run(flows):
                self._tell(flow.case, flow.case.steps[-1], 1.0, math.nan)
                outcomes[id(flow)] = outcome
        # In the order of the flows, so that results do not depend on timing
        for flow in flows:
            result = outcomes[id(flow)]
            if isinstance(result, ItemFailure):
                yield flow, CaseFailed(result.reason)
            else:
                yield flow, result


def solve_on_worker(
    place: CasePlace, model: TunnelModel, density: float, item: FoamCase | TunnelFlow
) -> Any:  # noqa: ANN401 - the facts of a mesh, or the result of a flow
    """Solve a mesh or a flow on this machine; density in kg/m3."""
    folder, retry_failed = place
    stages = CaseRunner(folder or cache_folder(), FoamPrograms(), lambda *_: None, retry_failed)
    try:
        if isinstance(item, FoamCase):
            return solve_mesh(stages, item)
        return solve_flow(stages, model, item, density)
    except CaseFailed as failure:
        raise BadInput(str(failure)) from None


def find_worker_openfoam_version() -> str:
    """Return the OpenFOAM version of this machine, or ''."""
    return find_openfoam_version() if has_openfoam() else ''


def check_cluster(address: str, flows: Sequence[TunnelFlow]) -> str:
    """
    Return the OpenFOAM versions of a cluster.

    Raise `BadInput` if dask.distributed is not installed, the scheduler does not answer, a worker
    has no OpenFOAM, or a mesh does not fit into its memory.
    """
    with closing(connect_cluster(address)) as client:
        engines: dict[str, str] = client.run(find_worker_openfoam_version)
        if lacking := [worker for worker, engine in engines.items() if not engine]:
            raise BadInput(
                f'OpenFOAM is not installed on the worker {lacking[0]}; install it with "sudo '
                'apt-get install --no-install-recommends openfoam", or stop that worker.'
            )
        for worker in client.scheduler_info(n_workers=-1)['workers'].values():
            if worker['memory_limit']:
                check_memory(flows, worker['nthreads'], worker['memory_limit'], MEMORY_REMEDY)
    return ', '.join(sorted(set(engines.values())))


CACHE: Any = option(
    'Folder that stores solved flows, so that later runs reuse them; with --scheduler, a folder '
    'on each worker machine.',
    default=None,
)


def refuse_solver_options(options: StudyOptions) -> None:
    """Raise `BadInput` for options of a solver where none runs."""
    if options != StudyOptions():
        raise BadInput(
            '--fidelity analytic solves no flow; leave --workers, --scheduler and --retry-failed '
            'out, or choose the fidelity preview or reference.'
        )


def check_solver_options(options: StudyOptions) -> None:
    """Raise `BadInput` for options that cannot solve a flow."""
    if options.scheduler is None:
        require_openfoam()
    elif options.workers is not None:
        # An ignored option would be misleading.
        raise BadInput(
            '--workers has no effect with --scheduler, where the threads of the Dask workers '
            'determine how many flows are solved at the same time; leave --workers out.'
        )


def open_solver(
    flows: Sequence[TunnelFlow], bar: TunnelProgress, options: StudyOptions, cache: Path | None,
    limit: float | None = None,
) -> FlowSolver:  # fmt: skip
    """
    Return the solver for some flows; raise `BadInput` if their meshes do not fit in memory.

    Parameters
    ----------
    flows : sequence of TunnelFlow
        All flows of the command.
    options : StudyOptions
        Flows at a time on this machine, or the scheduler of a cluster; whether to repeat failures.
    cache : Path, optional
        Cache folder of solved flows.
    limit : float, optional
        Memory of this machine. [GB]

    """
    tell, retry = bar.update_case_progress, options.retry_failed
    if options.scheduler is not None:
        engine = check_cluster(options.scheduler, flows)
        # The workers have other working directories, so the path must be absolute.
        place = cache and cache.absolute(), retry
        return DaskFlowSolver(options.scheduler, place, engine, tell)
    folder, side_by_side = resolve_cache_folder(cache), options.workers or count_cores()
    # The limit is an option in GB; memory is counted in bytes.
    check_memory(flows, side_by_side, 1e9 * limit if limit else machine_memory())
    bar.skip_solved(CaseRunner(folder, FoamPrograms(), tell))
    return ThreadedFlowSolver(folder, side_by_side, tell, retry)


def resolve_cache_folder(cache: Path | None) -> Path:
    """Return the cache folder of this machine."""
    return (cache or cache_folder()).absolute()
