"""Define the options of `lta cluster`: workers, threads and certificates."""

import os
from pathlib import Path
from typing import Annotated

from lta_config.errors import BadInput
from lta_report.cluster_server import TlsFiles, WorkerOptions
import typer

Workers = Annotated[
    int | None,
    typer.Option(help='Number of worker processes; one per processor by default.', min=1),
]
Threads = Annotated[
    int,
    typer.Option(help='Flights at the same time in each worker; processes are faster.', min=1),
]
TlsCa = Annotated[
    Path | None,
    typer.Option(
        help='Certificate of the authority that all machines trust (PEM).', metavar='FILE'
    ),
]
TlsCert = Annotated[
    Path | None, typer.Option(help='Certificate of this machine (PEM).', metavar='FILE')
]
TlsKey = Annotated[
    Path | None, typer.Option(help='Key of this certificate (PEM).', metavar='FILE')
]


def build_worker_options(
    workers: int | None,
    threads: int,
    authority: Path | None,
    certificate: Path | None,
    key: Path | None,
) -> WorkerOptions:
    """Return the workers to run; raise `BadInput` if a certificate is missing."""
    tls = None
    if authority is not None and certificate is not None and key is not None:
        tls = TlsFiles(authority.absolute(), certificate.absolute(), key.absolute())
    elif (authority, certificate, key) != (None, None, None):
        raise BadInput('Give all of --tls-ca, --tls-cert and --tls-key, or none of them.')
    # The processors that this process may use, not all of the machine
    return WorkerOptions(workers or len(os.sched_getaffinity(0)), threads, tls)
