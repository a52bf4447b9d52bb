# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Connect to a Dask cluster of the same LTA; only importer of the optional dask.distributed."""

from collections.abc import Callable
from importlib import import_module
import logging
import platform
from typing import Any, Final, NamedTuple
import warnings

from lta_bag.provenance import read_commit
from lta_config.errors import BadInput
from lta_config.version import VERSION

DASK: Final = 'distributed'
SCHEDULER_PATIENCE: Final = 10.0  # s to reach the scheduler
LOGGERS: Final = ('distributed', 'distributed.client', 'tornado.application')
TLS: Final = 'DASK_DISTRIBUTED__COMM__TLS__'  # Dask's settings, as environment variables
UNKNOWN_VERSION: Final = 'unknown'


class ClusterSoftware(NamedTuple):
    """Versions that must agree within a cluster."""

    # Version and commit of LTA; '' if it is not installed, or 'unknown'
    lta: str
    commit: str
    python: str  # such as '3.11'
    dask: str  # version of dask.distributed

    def matches(self, other: 'ClusterSoftware') -> bool:
        """Return whether both give the same results; what is unknown matches any."""
        return all(a == b or UNKNOWN_VERSION in (a, b) for a, b in zip(self, other, strict=True))

    def __str__(self) -> str:
        """Return all versions in one line."""
        # Twelve digits of a commit tell it apart; a suffix says that its files have changed
        digits, _, changed = self.commit.partition('-')
        commit_text = f' (commit {"-".join(filter(None, (digits[:12], changed)))})'
        commit = '' if self.commit == UNKNOWN_VERSION else commit_text
        lta = '' if self.lta == UNKNOWN_VERSION else f'LTA {self.lta}{commit}, '
        return f'{lta}Python {self.python} and Dask {self.dask}'


def import_dask() -> Any:
    """Return the module dask.distributed, or raise `BadInput` if it is not installed."""
    try:
        # Optional, so most installations do not have it
        return import_module(DASK)
    except ImportError:
        raise BadInput(
            'A Dask cluster needs the package dask.distributed, which is not installed; run '
            '"pip install distributed", in a source tree ".venv/bin/pip install -c '
            'constraints.txt -r requirements-dask.txt".'
        ) from None


def connect_cluster(address: str) -> Any:
    """
    Return a client of dask.distributed of the scheduler at an address.

    `address`: such as tcp://127.0.0.1:8786. Dask's configuration names the certificates for
    tls://. Raise `BadInput` if dask.distributed is not installed, no scheduler with workers
    answers, or the scheduler or a worker has another version of LTA, Python or Dask.
    """
    client = open_client(address)
    try:
        # A scheduler without workers would accept jobs and never run them
        client.wait_for_workers(1, timeout=SCHEDULER_PATIENCE)
        check_software(client)
    except OSError as error:
        client.close()
        raise BadInput(
            f"The Dask scheduler at '{address}' has no workers ({flatten_error(error)}); start "
            f'some with "dask worker {address}".'
        ) from None
    except BadInput:
        client.close()
        raise
    explain_losses(client, address)
    return client


def open_client(address: str) -> Any:
    """Return a client of a scheduler; raise `BadInput` if none answers."""
    dask = import_dask()
    # Dask prints the traceback of each lost connection; our errors say it
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            # Dask's table of versions; `check_software` says it in one sentence
            warnings.simplefilter('ignore')
            # Not the default client, which would capture Dask calls of the user's own code
            return dask.Client(address, timeout=SCHEDULER_PATIENCE, set_as_default=False)
    except TypeError:  # Dask's error for tls:// without certificates
        raise BadInput(
            f"The Dask scheduler at '{address}' needs certificates; set {TLS}CA_FILE, "
            f'{TLS}CLIENT__CERT and {TLS}CLIENT__KEY to their files.'
        ) from None
    except (OSError, ValueError) as error:
        raise BadInput(
            f"No Dask scheduler answers at '{address}' within {SCHEDULER_PATIENCE:.0f} s "
            f'({flatten_error(error)}); start one with "dask scheduler --host 127.0.0.1".'
        ) from None


def explain_losses(client: Any, address: str) -> None:
    """Let all calls of a client raise `BadInput` if the cluster loses its work or itself."""
    sync = client.sync

    # All blocking calls of a client and of its futures come through here
    def sync_or_explain(*given: Any, **options: Any) -> Any:
        try:
            return sync(*given, **options)
        except TimeoutError:
            raise
        # Dask cancels all work whose scheduler, or whose data on workers, is gone
        except (OSError, import_dask().CancelledError):
            raise BadInput(
                f"The Dask cluster at '{address}' has lost its scheduler or all of its workers; "
                'finished work is stored: start the cluster again and repeat the command to '
                'resume.'
            ) from None

    client.sync = sync_or_explain


def flatten_error(error: BaseException) -> str:
    """Return the message of an error in one line."""
    return ' '.join(str(error).split())


def check_software(client: Any) -> None:
    """Raise `BadInput` if the scheduler or a worker does not run this software."""
    ours = read_software()
    for name, theirs in read_cluster_software(client).items():
        if ours.matches(theirs):
            continue
        if not theirs.lta:
            raise BadInput(
                f'The {name} has no LTA, and this machine has {ours}; install the wheel of LTA '
                'there, and start it with the "dask" beside it.'
            )
        raise BadInput(
            f'The {name} has {theirs}, and this machine has {ours}; install the same versions on '
            'all machines of the cluster, and start it again.'
        )


def read_software() -> ClusterSoftware:
    """Return the versions of this process."""
    dask = import_dask().__version__
    return ClusterSoftware(VERSION, read_commit(), shorten_python(platform.python_version()), dask)


def read_cluster_software(client: Any) -> dict[str, ClusterSoftware]:
    """Return the versions of the scheduler and of all workers, by name."""
    # Dask's own request: it does not pickle a function, so it works between different Pythons
    versions = client.get_versions()
    scheduler = f'scheduler {client.scheduler.address}'
    packages = {
        scheduler: versions['scheduler']['packages'],
        **{f'worker {name}': each['packages'] for name, each in versions['workers'].items()},
    }
    # LTA is not asked for if the Pythons differ, which is reason enough
    installed: dict[str, tuple[str, str]] = {}
    pythons = {shorten_python(each['python']) for each in packages.values()}
    if pythons == {shorten_python(platform.python_version())}:
        read_lta = build_lta_reader()
        installed[scheduler] = client.run_on_scheduler(read_lta)
        installed |= {f'worker {name}': each for name, each in client.run(read_lta).items()}
    return {
        name: ClusterSoftware(
            *installed.get(name, (UNKNOWN_VERSION, UNKNOWN_VERSION)),
            shorten_python(each['python']),
            each['distributed'],
        )
        for name, each in packages.items()
    }


def shorten_python(version: str) -> str:
    """Return '3.11' for '3.11.7' and '3.11.7.final.0'."""
    return '.'.join(version.split('.')[:2])


def build_lta_reader() -> Callable[[], tuple[str, str]]:
    """Return a function that returns the LTA version and commit, '' if it is not installed."""

    def read_lta() -> tuple[str, str]:
        # Nested, so that Dask sends its code and not its name, which a worker may not find
        from importlib import import_module

        try:
            version: str = import_module('lta_config.version').VERSION
            commit: str = import_module('lta_bag.provenance').read_commit()
        except ImportError:
            return '', ''
        return version, commit

    return read_lta
