# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""lta run: run one executable like `ros2 run`."""

import os
from pathlib import Path
import signal
import sys
from typing import Annotated

from lta_config.errors import BadInput
from lta_graph.ament import find_executable, OUR_PREFIX
import typer


def run(
    package: Annotated[
        str,
        typer.Argument(
            metavar='PACKAGE|FILE', help='Package, for example lta_vlc, or your own .py file.'
        ),
    ],
    arguments: Annotated[
        list[str] | None,
        typer.Argument(
            metavar='[NAME] [ARGUMENTS]...',
            help='Executable of the package, for example demodulator; then arguments for it, for '
            'example --ros-args -p seed:=2.',
        ),
    ] = None,
) -> None:
    """
    Run one executable of one package, as "ros2 run" does, or your own Python file.

    The file sees rclpy and the graph as the nodes of LTA do.

    Example: lta run lta_vlc demodulator --ros-args -r __ns:=/lta1 -p frequency:=170.0
    """
    words = arguments or []
    if package.endswith('.py'):
        if not Path(package).is_file():
            raise BadInput(f'There is no Python file {package}; check the path.')
        os.execv(sys.executable, [sys.executable, package, *words])
    if not words:
        raise BadInput(f"The executable of '{package}' is missing; write lta run {package} NAME.")
    name, *rest = words
    path = find_executable(package, name)
    if package.startswith(OUR_PREFIX):
        # Block SIGINT until the entry point installs its handler: Ctrl-C during the imports would
        # print a traceback.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    # Replaces this process: signals and exit status are those of the executable
    os.execv(path, [str(path), *rest])
