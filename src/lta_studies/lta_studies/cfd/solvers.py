"""Choose the solver of the flows: this machine or a Dask cluster."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.request import option
from lta_report.study import StudyOptions
from lta_studies.cfd.cluster import DaskFlowSolver
from lta_studies.cfd.progress import TunnelProgress
from lta_windtunnel.flow_plan import TunnelFlow
from lta_windtunnel.flow_solvers import FlowSolver, ThreadedFlowSolver
from lta_windtunnel.openfoam.case import cache_folder, CaseRunner
from lta_windtunnel.openfoam.programs import FoamPrograms, require_openfoam
from lta_windtunnel.solve import check_memory, machine_memory

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


@contextmanager
def open_solver(
    flows: Sequence[TunnelFlow], bar: TunnelProgress, options: StudyOptions, cache: Path | None,
    limit: float | None = None,
) -> Iterator[FlowSolver]:  # fmt: skip
    """
    Open the solver for some flows; raise `BadInput` if their meshes do not fit in memory.

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
        # The workers have other working directories, so the path must be absolute.
        absolute = cache and cache.absolute()
        with DaskFlowSolver(options.scheduler, absolute, tell, retry) as cluster:
            cluster.check_memory(flows)
            yield cluster
        return
    folder, side_by_side = resolve_cache_folder(cache), options.workers or count_cores()
    # The limit is an option in GB; memory is counted in bytes.
    check_memory(flows, side_by_side, 1e9 * limit if limit else machine_memory())
    bar.skip_solved(CaseRunner(folder, FoamPrograms(), tell))
    yield ThreadedFlowSolver(folder, side_by_side, tell, retry)


def resolve_cache_folder(cache: Path | None) -> Path:
    """Return the cache folder of this machine."""
    return (cache or cache_folder()).absolute()
