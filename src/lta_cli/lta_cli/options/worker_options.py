"""Define the options of studies that work in parallel: --workers, --scheduler, --retry-failed."""

from typing import Annotated

import typer

WorkerCount = Annotated[
    int | None,
    typer.Option(
        '--workers', help='Number of worker processes; one per processor by default.', min=1
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar='ADDRESS',
        help='Use a Dask cluster; address of its scheduler, such as tcp://127.0.0.1:8786.',
    ),
]
RetryFailed = Annotated[
    bool, typer.Option('--retry-failed', help='Repeat what failed in an earlier run.')
]
