"""
A Dask cluster that solves the flows of a wind tunnel.

Its machines need LTA and OpenFOAM. A flow is solved and read where it lies, and only its numbers
travel. Each machine keeps what it has solved; a folder that all of them share (--cache) spares
them each other's meshes.
"""

from collections.abc import Generator, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Final, final, Self

from lta_config.errors import BadInput
from lta_report.cluster import connected
from lta_sim.cfd.crew import Found, found_of, mesh_of, meshed, meshes_of
from lta_sim.cfd.model import Model
from lta_sim.cfd.openfoam.case import Case
from lta_sim.cfd.openfoam.engine import CaseFailed, openfoam, Programs, version
from lta_sim.cfd.openfoam.stage import cache_folder, Progress, Stages
from lta_sim.cfd.plan import Flow
from lta_sim.cfd.solve import check_memory

REMEDY: Final = 'give its workers fewer threads or more memory, or take a coarser fidelity'


@final
class ClusterCrew:
    """
    Workers of a Dask cluster, a flow a thread.

    Parameters
    ----------
    address : str
        Of the scheduler, such as tcp://10.0.0.1:8786.
    folder : Path, optional
        Where solved cases are kept, on every machine; each one's own cache by default.
    tell : callable
        Told what has been solved.

    Raises
    ------
    BadInput
        If dask.distributed is not installed, nobody answers there, or a worker has no OpenFOAM.

    """

    def __init__(self, address: str, folder: Path | None, tell: Progress) -> None:
        _, self._client = connected(address)
        self._folder, self._tell = folder, tell
        self._engines: dict[str, str] = self._client.run(engine_there)
        if lacking := [worker for worker, engine in self._engines.items() if not engine]:
            self._client.close()
            raise BadInput(
                f'OpenFOAM is not installed where the worker {lacking[0]} runs: "sudo apt-get '
                'install --no-install-recommends openfoam" brings it, or stop that worker.'
            )

    def __enter__(self) -> Self:
        """Take the cluster."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Take back what has not begun; a program that runs ends, and its flow is kept there."""
        with suppress(OSError):
            self._client.close()

    def engine(self) -> str:
        """Return what they are solved with."""
        return ', '.join(sorted(set(self._engines.values())))

    def check(self, flows: Sequence[Flow]) -> None:
        """Refuse, before any work, meshes that would not fit into a worker's memory."""
        for worker in self._client.scheduler_info(n_workers=-1)['workers'].values():
            if worker['memory_limit']:
                check_memory(flows, worker['nthreads'], worker['memory_limit'], REMEDY)

    def solved(
        self, model: Model, flows: Sequence[Flow], density: float
    ) -> Generator[tuple[Flow, Found | CaseFailed]]:
        """Yield each flow with what came of it; parameters as `found_of`."""
        meshes = {mesh.key: self._begin(mesh, mesh_there, mesh) for mesh in meshes_of(flows)}
        there = self._client.scatter(model, hash=False)
        coming = [
            (flow, self._begin(flow.case, flow_there, there, flow, density,
                               meshes[mesh_of(flow).key]))
            for flow in flows
        ]  # fmt: skip
        for flow, future in coming:
            try:
                yield flow, future.result()
            except CaseFailed as error:
                yield flow, error
            except Exception as error:  # whatever befell the worker
                reason = ' '.join(str(error).split())
                yield (
                    flow,
                    CaseFailed(
                        f'The cluster gave it up ({type(error).__name__}: {reason}); '
                        'start again to go on.'
                    ),
                )

    def _begin(self, case: Case, work: Any, *given: Any) -> Any:  # noqa: ANN401 - Dask has no types
        future = self._client.submit(work, self._folder, *given, pure=False)
        future.add_done_callback(lambda _: self._tell(case, case.steps[-1], 1.0, float('nan')))
        return future


def engine_there() -> str:
    """Return which OpenFOAM this machine has, or nothing."""
    return version() if openfoam() else ''


def mesh_there(folder: Path | None, mesh: Case) -> None:
    """Make a mesh on this machine."""
    meshed(_stages(folder), mesh)


def flow_there(folder: Path | None, model: Model, flow: Flow, density: float, _: None) -> Found:
    """Solve and read a flow on this machine, when its mesh has been made."""
    return found_of(_stages(folder), model, flow, density)


def _stages(folder: Path | None) -> Stages:
    return Stages(folder or cache_folder(), Programs(), lambda *_: None)
