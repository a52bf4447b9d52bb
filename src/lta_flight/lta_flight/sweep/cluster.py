"""
A Dask cluster that flies a sweep.

The machines of the cluster need LTA and the same files of configuration only as far as they are
shipped: what a flight is made of travels with it.
"""

from collections.abc import Iterator
from contextlib import suppress
from types import TracebackType
from typing import Any, final, Self

from lta_flight.ingredients import Ingredients
from lta_flight.sweep.flown import failed, fly_job, Row
from lta_flight.sweep.plan import Job
from lta_report.cluster import connected

AHEAD = 4  # jobs a thread of the cluster has waiting


@final
class ClusterCrew:
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

    def __init__(self, base: Ingredients, address: str) -> None:
        self._dask, self._client = connected(address)
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

    def fly(self, jobs: Iterator[Job]) -> Iterator[Row]:
        """Yield the rows of all jobs as they come; what a lost worker had is flown again."""
        given: dict[Any, Job] = {}
        threads = sum(self._client.nthreads().values()) or 1
        flying = self._dask.as_completed([], loop=self._client.loop)
        for _ in range(AHEAD * threads):
            self._give(jobs, given, flying)
        for future in flying:
            job = given.pop(future.key)
            error = future.exception()
            yield future.result() if error is None else self._given_up(job, error)
            future.release()
            self._give(jobs, given, flying)

    def _give(self, jobs: Iterator[Job], given: dict[Any, Job], flying: Any) -> None:  # noqa: ANN401
        job = next(jobs, None)
        if job is not None:
            future = self._client.submit(fly_job, self._common, job, pure=False)
            given[future.key] = job
            flying.add(future)

    def _given_up(self, job: Job, error: BaseException) -> Row:
        self.deaths += 1
        reason = ' '.join(str(error).split())
        return failed(job, f'The cluster gave this flight up: {type(error).__name__}: {reason}')
