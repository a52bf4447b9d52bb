"""
A Dask cluster that flies a sweep.

The machines of the cluster need LTA and the same files of configuration only as far as they are
shipped: what a flight is made of travels with it.
"""

from collections.abc import Iterator
from contextlib import suppress
from types import TracebackType
from typing import Any, final, Self

from lta_flight.flight_spec import FlightSpec
from lta_flight.sweep.job_runner import build_failed_row, fly_job, SweepRow
from lta_flight.sweep.plan import SweepJob
from lta_report.cluster import connect_cluster

AHEAD = 4  # jobs a thread of the cluster has waiting


@final
class SweepCluster:
    """
    Workers of a Dask cluster.

    Parameters
    ----------
    base : Ingredients
        What all flights have in common.
    address : str
        Of the scheduler, such as tcp://10.0.0.1:8786.

    Raises
    ------
    BadInput
        If dask.distributed is not installed, or nobody answers there.

    """

    def __init__(self, base: FlightSpec, address: str) -> None:
        self._dask, self._client = connect_cluster(address)
        self._base = base
        self.deaths = 0  # Dask replaces workers by itself and does not tell

    def __enter__(self) -> Self:
        """Send once what all flights have in common."""
        self._common = self._client.scatter(self._base, broadcast=True, hash=False)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Take back what has not been flown, and leave the cluster as it was."""
        with suppress(OSError):
            self._client.close()

    def run_jobs(self, jobs: Iterator[SweepJob]) -> Iterator[SweepRow]:
        """Yield the rows of all jobs as they come; what a lost worker had is flown again."""
        given: dict[Any, SweepJob] = {}
        threads = sum(self._client.nthreads().values()) or 1
        flying = self._dask.as_completed([], loop=self._client.loop)
        for _ in range(AHEAD * threads):
            self._submit_next(jobs, given, flying)
        for future in flying:
            job = given.pop(future.key)
            error = future.exception()
            yield future.result() if error is None else self._build_failed_row(job, error)
            future.release()
            self._submit_next(jobs, given, flying)

    def _submit_next(
        self,
        jobs: Iterator[SweepJob],
        pending: dict[Any, SweepJob],
        flying: Any,  # noqa: ANN401
    ) -> None:
        job = next(jobs, None)
        if job is not None:
            future = self._client.submit(fly_job, self._common, job, pure=False)
            pending[future.key] = job
            flying.add(future)

    def _build_failed_row(self, job: SweepJob, error: BaseException) -> SweepRow:
        self.deaths += 1
        reason = ' '.join(str(error).split())
        return build_failed_row(
            job, f'The cluster gave this flight up: {type(error).__name__}: {reason}'
        )
