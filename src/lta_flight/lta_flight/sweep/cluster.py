"""
Fly a sweep on a Dask cluster.

The machines of the cluster need LTA with its shipped files only, because the flight's own files
are sent to them.
"""

from collections.abc import Iterator
from contextlib import suppress
from types import TracebackType
from typing import Any, final, Self

from lta_flight.flight_spec import FlightSpec
from lta_flight.sweep.job_runner import build_failed_row, fly_job, SweepRow
from lta_flight.sweep.plan import SweepJob
from lta_report.cluster import connect_cluster

AHEAD = 4  # jobs queued per thread, so that none waits for the network


@final
class SweepCluster:
    """
    Workers of a Dask cluster.

    Parameters
    ----------
    base : FlightSpec
        What all flights have in common.
    address : str
        Address of the scheduler, such as tcp://10.0.0.1:8786.

    Raises
    ------
    BadInput
        If dask.distributed is not installed, or no scheduler answers.

    """

    def __init__(self, base: FlightSpec, address: str) -> None:
        self._dask, self._client = connect_cluster(address)
        self._base = base
        self.deaths = 0  # flights given up; Dask replaces lost workers silently

    def __enter__(self) -> Self:
        """Send the common part of all flights once."""
        self._common = self._client.scatter(self._base, broadcast=True, hash=False)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Cancel pending flights and disconnect."""
        with suppress(OSError):
            self._client.close()

    def run_jobs(self, jobs: Iterator[SweepJob]) -> Iterator[SweepRow]:
        """Yield the rows of jobs as they finish; Dask repeats jobs of lost workers."""
        given: dict[Any, SweepJob] = {}
        # At least one, if the workers have just been lost
        threads = sum(self._client.nthreads().values()) or 1
        flying = self._dask.as_completed([], loop=self._client.loop)
        for _ in range(AHEAD * threads):
            self._submit_next(jobs, given, flying)
        for future in flying:
            job = given.pop(future.key)
            # Only infrastructure fails here; errors of a flight are in its row
            error = future.exception()
            yield future.result() if error is None else self._build_failed_row(job, error)
            # Frees the result on the cluster
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
            # pure=False: equal arguments must not return an earlier result
            future = self._client.submit(fly_job, self._common, job, pure=False)
            pending[future.key] = job
            flying.add(future)

    def _build_failed_row(self, job: SweepJob, error: BaseException) -> SweepRow:
        self.deaths += 1
        reason = ' '.join(str(error).split())
        return build_failed_row(
            job, f'The Dask cluster could not finish this flight: {type(error).__name__}: {reason}'
        )
