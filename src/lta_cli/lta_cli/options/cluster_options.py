"""Define the options of `lta cluster`: workers, threads and certificates."""

from pathlib import Path
from typing import Annotated

from lta_config.errors import BadInput
from lta_config.machine import count_cores
from lta_report.cluster_server import TlsFiles, WorkerOptions
import typer

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
    return WorkerOptions(workers or count_cores(), threads, tls)
