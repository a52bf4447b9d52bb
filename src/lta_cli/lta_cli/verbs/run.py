"""lta run: run one executable like `ros2 run`."""

import os
import signal
from typing import Annotated

from lta_graph.ament import find_executable
import typer

OURS = 'lta_'


def run(
    package: Annotated[str, typer.Argument(help='Package, for example lta_vlc.')],
    name: Annotated[str, typer.Argument(help='Executable, for example demodulator.')],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(help='Arguments for the executable, for example --ros-args -p seed:=2.'),
    ] = None,
) -> None:
    """
    Run one executable of one package, as "ros2 run" does.

    Example: lta run lta_vlc demodulator --ros-args -r __ns:=/lta1 -p frequency:=170.0
    """
    path = find_executable(package, name)
    if package.startswith(OURS):
        # Block SIGINT until the entry point installs its handler: Ctrl-C during the imports would
        # print a traceback.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    # Replaces this process: signals and exit status are those of the executable
    os.execv(path, [str(path), *(arguments or [])])
