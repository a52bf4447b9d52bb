"""lta run: one executable, as `ros2 run` would."""

import os
from typing import Annotated

from lta_graph.ament import find_executable
import typer


def run(
    package: Annotated[str, typer.Argument(help='Package, for example lta_vlc.')],
    name: Annotated[str, typer.Argument(help='Executable, for example demodulator.')],
    arguments: Annotated[
        list[str] | None, typer.Argument(help='Passed on, for example --ros-args -p seed:=2.')
    ] = None,
) -> None:
    """
    Run one executable of one package, as "ros2 run" does.

    Example: lta run lta_vlc demodulator --ros-args -r __ns:=/lta1 -p frequency:=175.0
    """
    path = find_executable(package, name)
    os.execv(path, [str(path), *(arguments or [])])
