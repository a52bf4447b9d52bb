"""lta replay: rerun nodes on a recording and compare their outputs with it."""

from pathlib import Path
from typing import Annotated

from lta_bridge.playback.settings import FOREVER
from lta_cli.options.common_options import RobotOption
from lta_cli.options.study_command import report_command, StudyRun
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.recorded_flight import open_flight
from lta_flight.replay.node_settings import parse_settings
from lta_flight.replay.progress import ReplayProgress
from lta_flight.replay.replay_request import parse_nodes, ReplayRequest
from lta_flight.replay.report import build_report
from lta_flight.replay.run import run_replay
from lta_flight.replay.verdict import compare_with_recording
from lta_report.report import Report
import typer


@report_command('replay')
def replay(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    nodes: Annotated[
        str, typer.Option(help='Nodes to rerun, separated by commas.')
    ] = 'demodulator,navigator',
    against: Annotated[
        bool,
        typer.Option(
            '--against', help='Compare all outputs of the rerun nodes with the recorded ones.'
        ),
    ] = False,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            '--set', help='Set a parameter of a rerun node: NODE.PARAMETER=VALUE; repeatable.'
        ),
    ] = None,
    strategy: Annotated[
        str | None, typer.Option(help='Navigation strategy to use instead of the recorded one.')
    ] = None,
    vehicle: Annotated[
        str | None, typer.Option(help='Vehicle to use instead of the recorded one, name or file.')
    ] = None,
    gains: Annotated[
        str | None,
        typer.Option(help='Controller gains to use instead of the recorded ones, name or file.'),
    ] = None,
    robot: RobotOption = None,
    rate: Annotated[
        float | None,
        typer.Option(
            help='Playback speed relative to real time; by default as fast as the nodes respond.',
            min=1e-3,
            max=1e6,
        ),
    ] = None,
    start: Annotated[
        float, typer.Option(help='Start time in seconds after the first message.', min=0.0)
    ] = 0.0,
    end: Annotated[
        float | None, typer.Option(help='End time in seconds after the first message.', min=0.0)
    ] = None,
    *,
    run: StudyRun,
) -> Report:
    """
    Rerun nodes on a recording and check whether they decide as before.

    The player publishes the recorded inputs, including those of nodes that are not rerun; the
    nodes respond as fast as they can, and no message is lost. Vehicle, gains and strategy come
    from the bag unless given.

    Exit status 0: done; with --against, bit-identical, or within 1e-9 with the same decisions if
    the bag comes from other versions or another machine. 1: different, or a node did not respond.
    2: bad input. 130: Ctrl-C.

    Example: lta replay runs/flight --nodes demodulator,navigator --against --set
    demodulator.window=4
    """
    names = parse_nodes(nodes)
    order = ReplayRequest(
        find_bag(bag).absolute(), names, parse_settings(set_ or [], names), vehicle, gains,
        strategy, rate, start, FOREVER if end is None else end,
    )  # fmt: skip
    flight = open_flight(order.bag, robot)
    # ns to s; a damaged bag may have no times
    span = ((flight.bag.end or 0) - (flight.bag.start or 0)) * 1e-9
    with ReplayProgress(run.console, max(0.0, min(span, order.end) - start)) as progress:
        played = run_replay(order, flight, run.folder, progress)
    verdict = (
        compare_with_recording(flight, open_flight(played.bag), order.node_selection.answers)
        if against
        else None
    )
    return build_report(played, verdict, order, flight.provenance)
