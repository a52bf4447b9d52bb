"""Run the scheduler and the workers of a Dask cluster in this process and its children."""

import asyncio
from collections.abc import Callable, Coroutine
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from ipaddress import ip_address
import logging
from pathlib import Path
import socket
import ssl
from threading import Thread
from typing import Any, Final, final, TypeVar
from urllib.parse import urlsplit

from lta_config.errors import BadInput
from lta_report.cluster import check_software, import_dask, open_client, silence_logs

Result = TypeVar('Result')

CONFIG: Final = 'dask.config'  # optional, as all of Dask
PORT: Final = 8786  # Dask's default
PATIENCE: Final = 60.0  # s for a scheduler to start, or to come back
CLOSING: Final = 10.0  # s for the workers to end
START: Final = 'start one there with "lta cluster up", or correct the address'
SETTINGS: Final = {
    # Sampling the stacks of flights 100 times per second serves only the dashboard
    'distributed.worker.profile.enabled': False,
    'distributed.diagnostics.nvml': False,
    # As `silence_logs`, in the worker processes
    'distributed.nanny.pre-spawn-environ.DASK_LOGGING__DISTRIBUTED': 'critical',
    # No module is taken from the current folder
    'distributed.nanny.pre-spawn-environ.PYTHONSAFEPATH': '1',
}
# Dask's web server has no encryption, so other machines must not reach it
WEB: Final = {'dashboard': False, 'dashboard_address': '127.0.0.1:0'}


@final
@dataclass(frozen=True, slots=True)
class TlsFiles:
    """Certificates in PEM format; all machines of a cluster trust what the authority signed."""

    authority: Path
    certificate: Path
    key: Path


@final
@dataclass(frozen=True, slots=True)
class WorkerOptions:
    """Number of worker processes, threads of each, and certificates."""

    count: int
    threads: int
    tls: TlsFiles | None


def serve_cluster(
    host: str, port: int, options: WorkerOptions, announce: Callable[[str], None]
) -> None:
    """
    Run a scheduler and workers until Ctrl-C.

    `host`, `port`: where the scheduler listens; port 0 takes a free one. `options`: workers on
    this machine. `announce`: called with the address of the scheduler when all workers are ready.
    Raise `BadInput` if dask.distributed is not installed, the port is in use, the certificates
    cannot be used, or other machines could connect without them.
    """
    with ClusterServer() as server:
        address = server.start_scheduler(host, port, options.tls)
        server.start_workers(address, options)
        announce(address)
        server.wait_closed()


def join_cluster(address: str, options: WorkerOptions, announce: Callable[[str], None]) -> None:
    """
    Run workers of a scheduler elsewhere until Ctrl-C; rejoin it when it is started again.

    `address`: address of the scheduler, such as tls://10.0.0.1:8786. `options`: workers on this
    machine. `announce`: called with the address each time all workers have joined. Raise
    `BadInput` if dask.distributed is not installed, no scheduler answers in time, it has other
    versions, the certificates cannot be used, or they are missing.
    """
    check_scheduler_address(address, options.tls)
    with ClusterServer() as server:
        while True:
            client = open_client(address, PATIENCE, START, security=build_security(options.tls))
            with client:
                check_software(client)
            server.start_workers(address, options)
            announce(address)
            server.wait_closed()


def check_scheduler_address(address: str, tls: TlsFiles | None) -> None:
    """Raise `BadInput` for an invalid address, or one that does not match the certificates."""
    parts = urlsplit(address)
    try:
        valid = parts.scheme in ('tcp', 'tls') and parts.hostname and parts.port
    except ValueError:  # a port that is not a number
        valid = False
    if not valid or parts.hostname is None:
        raise BadInput(
            f"The address '{address}' is invalid; give one such as tcp://127.0.0.1:{PORT} or "
            f'tls://10.0.0.1:{PORT}.'
        )
    if (parts.scheme == 'tls') != (tls is not None):
        raise BadInput(
            f"The address '{address}' does not match the certificates; give --tls-ca, --tls-cert "
            'and --tls-key with a tls:// address, and only with one.'
        )
    check_encryption(parts.hostname, tls)


def find_own_address(address: str) -> str:
    """Return the IP address of this machine on the way to a scheduler."""
    parts = urlsplit(address)
    family, kind, _, _, place = socket.getaddrinfo(
        parts.hostname, parts.port, type=socket.SOCK_DGRAM
    )[0]
    with socket.socket(family, kind) as probe:
        # Connecting a UDP socket only chooses the interface; nothing is sent
        probe.connect(place)
        return str(probe.getsockname()[0])


def is_loopback(host: str) -> bool:
    """Return whether only this machine reaches a host; raise `BadInput` for an unknown name."""
    try:
        return ip_address(socket.gethostbyname(host)).is_loopback
    except OSError as error:
        raise BadInput(f"The host '{host}' is unknown ({error.strerror}); correct it.") from None


def check_encryption(host: str, tls: TlsFiles | None) -> None:
    """Refuse to listen unencrypted where other machines can connect: Dask runs any code."""
    if tls is None and not is_loopback(host):
        raise BadInput(
            f"A cluster on '{host}' runs any code that other machines send to it, so it needs "
            'certificates; add --tls-ca, --tls-cert and --tls-key, or use 127.0.0.1 and an SSH '
            'tunnel.'
        )


def check_port(host: str, port: int) -> None:
    """Raise `BadInput` if a scheduler cannot listen at an address."""
    with socket.socket() as probe:
        # As Dask does, to reuse the port of a scheduler that has just ended
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise BadInput(
                f'Cannot listen on port {port} of {host} ({error.strerror}); choose another '
                '--port, or end the program that uses it.'
            ) from None


def build_security(tls: TlsFiles | None) -> Any:  # noqa: ANN401 - Dask has no types
    """Return Dask's security settings; raise `BadInput` for unusable certificates."""
    if tls is None:
        return None
    try:
        # Dask reads them later, and its errors name no file
        context = ssl.create_default_context(cafile=str(tls.authority))
        context.load_cert_chain(tls.certificate, tls.key)
    except OSError as error:  # also the errors of ssl
        raise BadInput(
            f'The certificates {tls.authority}, {tls.certificate} and {tls.key} cannot be used '
            f'({error.strerror}); give PEM files of an authority, a certificate it signed, and '
            'its key.'
        ) from None
    roles = ('client', 'scheduler', 'worker')
    return import_dask().Security(
        require_encryption=True,
        tls_ca_file=str(tls.authority),
        **{f'tls_{role}_cert': str(tls.certificate) for role in roles},
        **{f'tls_{role}_key': str(tls.key) for role in roles},
    )


@final
class ClusterServer:
    """
    Scheduler and workers in the background, as a context manager that ends them.

    Their event loop has its own thread, so Ctrl-C interrupts only the waiting main thread.
    """

    def __init__(self) -> None:
        self._dask = import_dask()
        import_module(CONFIG).set(SETTINGS)
        silence_logs()
        self._servers: list[Any] = []

    def __enter__(self) -> 'ClusterServer':
        """Start the event loop."""
        self._loop = asyncio.new_event_loop()
        self._thread = Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End workers and scheduler; those that do not end in time end with this process."""
        with suppress(TimeoutError):
            self._run(asyncio.wait_for(self._close(), CLOSING))
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def start_scheduler(self, host: str, port: int, tls: TlsFiles | None) -> str:
        """Start a scheduler and return its address; raise `BadInput` if it cannot listen."""
        check_encryption(host, tls)
        check_port(host, port)
        options = {
            'host': host,
            'port': port,
            'protocol': 'tls://' if tls else 'tcp://',
            'security': build_security(tls),
            **WEB,
        }
        scheduler = self._run(self._start(self._dask.Scheduler, options, 1))[0]
        return str(scheduler.address)

    def start_workers(self, address: str, options: WorkerOptions) -> None:
        """Start workers of the scheduler at an address; each that dies is replaced."""
        settings = {
            'scheduler_ip': address,
            'nthreads': options.threads,
            # By default, Dask listens on all interfaces
            'host': find_own_address(address),
            'protocol': urlsplit(address).scheme + '://',
            'security': build_security(options.tls),
            'silence_logs': logging.CRITICAL,
            'death_timeout': PATIENCE,
            **WEB,
        }
        self._run(self._start(self._dask.Nanny, settings, options.count))

    def wait_closed(self) -> None:
        """Wait until scheduler and workers have ended, which they do not by themselves."""
        self._run(self._wait_closed())
        self._servers.clear()

    def _run(self, work: Coroutine[Any, Any, Result]) -> Result:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()

    async def _start(self, kind: Any, options: dict[str, Any], count: int) -> list[Any]:  # noqa: ANN401 - Dask has no types
        # Within the event loop, which both take from where they are created
        started = [kind(**options) for _ in range(count)]
        self._servers += started
        await asyncio.gather(*started)
        return started

    async def _wait_closed(self) -> None:
        await asyncio.gather(*(each.finished() for each in self._servers))

    async def _close(self) -> None:
        # Workers first: they tell the scheduler
        for each in reversed(self._servers):
            with suppress(Exception):
                await each.close()
