"""lta cluster up: start a Dask scheduler with workers on this machine."""

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
from lta_config.command_line import format_lta_command
from lta_report.cluster import TLS
from lta_report.cluster_server import PORT, serve_cluster, TlsFiles
from lta_report.formatting import format_count
import typer


def up(
    workers: WorkerCount = None,
    threads: Threads = 1,
    host: Annotated[
        str,
        typer.Option(
            help='Address to listen at; only this machine reaches the default. Another needs '
            'certificates.'
        ),
    ] = '127.0.0.1',
    port: Annotated[
        int, typer.Option(help='Port of the scheduler; 0 takes a free one.', min=0, max=65535)
    ] = PORT,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
) -> None:
    """
    Start a Dask scheduler with workers on this machine, and run them until Ctrl-C.

    Prints the commands to fly a sweep on the cluster and to add other machines. A worker that
    dies is replaced. Whoever can connect to a cluster can run any program on its machines:
    without certificates it listens at this machine only. docs/cluster.md has examples for several
    machines, SLURM and Kubernetes.

    Exit status 2: bad input, nothing was started. 130: Ctrl-C.

    Example: lta cluster up --workers 4
    """
    options = build_worker_options(workers, threads, tls_ca, tls_cert, tls_key)
    console = plain_console()

    def announce(address: str) -> None:
        lines = [
            f'Dask scheduler and {format_count(options.count, "worker")} at {address}; Ctrl-C '
            'stops them.',
            f'Fly a sweep: {format_sweep_command(address, options.tls)}',
            f'Add workers: {format_join_command(address, options.tls)}',
        ]
        console.print('\n'.join(lines), highlight=False, markup=False, soft_wrap=True)

    serve_cluster(host, port, options, announce)


def format_sweep_command(address: str, tls: TlsFiles | None) -> str:
    """Return the command that flies a sweep on the cluster, with Dask's names for certificates."""
    command = format_lta_command('sweep', 'heaviness', '--scheduler', address)
    if tls is None:
        return command
    return (
        f'{TLS}CA_FILE={tls.authority} {TLS}CLIENT__CERT={tls.certificate} '
        f'{TLS}CLIENT__KEY={tls.key} {command}'
    )


def format_join_command(address: str, tls: TlsFiles | None) -> str:
    """Return the command that adds the workers of another machine to the cluster."""
    files: tuple[object, ...] = ()
    if tls is not None:
        files = ('--tls-ca', tls.authority, '--tls-cert', tls.certificate, '--tls-key', tls.key)
    return format_lta_command('cluster', 'join', address, *map(str, files))
