"""lta cluster join: add the workers of this machine to a Dask scheduler."""

from typing import Annotated

from lta_analysis.console import plain_console
from lta_cli.options.cluster_options import (
    build_worker_options,
    Threads,
    TlsCa,
    TlsCert,
    TlsKey,
)
from lta_cli.options.common_options import WorkerCount
from lta_report.cluster_server import join_cluster
from lta_report.formatting import format_count
import typer


def join(
    address: Annotated[
        str, typer.Argument(help='Address of the scheduler, as "lta cluster up" prints it.')
    ],
    workers: WorkerCount = None,
    threads: Threads = 1,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
) -> None:
    """
    Add workers on this machine to a Dask scheduler, and run them until Ctrl-C.

    Waits a minute for the scheduler, at the start and whenever the connection is lost. A machine
    with another version of LTA, Python or Dask is refused. The scheduler and the other workers
    connect to these workers, so another machine needs a network between them and certificates; an
    SSH tunnel suffices only for the machine that runs "lta sweep".

    Exit status 2: bad input, or no scheduler for a minute. 130: Ctrl-C.

    Example: lta cluster join tcp://127.0.0.1:8786 --workers 2
    """
    options = build_worker_options(workers, threads, tls_ca, tls_cert, tls_key)
    console = plain_console()

    def announce(address: str) -> None:
        console.print(
            f'Joined {address} with {format_count(options.count, "worker")}; Ctrl-C stops them.',
            highlight=False,
            markup=False,
            soft_wrap=True,
        )

    join_cluster(address, options, announce)
