"""Connect to a Dask cluster; the only importer of the optional package dask.distributed."""

from importlib import import_module
from typing import Any, Final

from lta_config.errors import BadInput

DASK: Final = 'distributed'
PATIENCE: Final = 10.0  # s to reach the scheduler


def connect_cluster(address: str) -> tuple[Any, Any]:
    """
    Return the module dask.distributed, and a client of the scheduler at an address.

    Parameters
    ----------
    address : str
        Such as tcp://10.0.0.1:8786.

    Raises
    ------
    BadInput
        If dask.distributed is not installed, or no scheduler answers.

    """
    try:
        # Optional, so most installations do not have it
        dask: Any = import_module(DASK)
    except ImportError:
        raise BadInput(
            'A Dask cluster needs the package dask.distributed, which is not installed; '
            'run "pip install -r requirements-dask.txt".'
        ) from None
    try:
        # Not the default client, which would capture Dask calls of the user's own code
        client: Any = dask.Client(address, timeout=PATIENCE, set_as_default=False)
        # A scheduler without workers would accept jobs and never run them
        client.wait_for_workers(1, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise BadInput(
            f"No Dask scheduler with workers answers at '{address}' "
            f'({" ".join(str(error).split())}); start "dask scheduler" and "dask worker".'
        ) from None
    return dask, client
