"""lta replay: rerun nodes on a recording and compare their outputs with it."""

from pathlib import Path
import sys
from typing import Annotated

from lta_bridge.playback.settings import FOREVER
from lta_cli.options.output_options import Json, parse_folder
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import relative_path
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_flight.replay.node_settings import parse_settings
from lta_flight.replay.page import format_largest_change, format_value, write_page
from lta_flight.replay.progress import ReplayProgress
from lta_flight.replay.replay_request import parse_nodes, ReplayRequest
from lta_flight.replay.run import ReplayRun, run_replay
from lta_flight.replay.verdict import compare_with_recording, ReplayVerdict
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from rich.console import Console
from rich.table import Column, Table
import typer

WORST = 3  # channels of a topic on the terminal


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
    robot: Annotated[
        str | None, typer.Option(help='Robot to replay; needed if the bag has several.')
    ] = None,
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
    out: Annotated[
        Path | None,
        typer.Option(
            help='Folder of the results; runs/<time>-replay by default.',
            parser=parse_folder,
            metavar='FOLDER',
        ),
    ] = None,
    json: Json = False,
) -> None:
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
    console = plain_console(stderr=json)
    names = parse_nodes(nodes)
    order = ReplayRequest(
        find_bag(bag).absolute(), names, parse_settings(set_ or [], names), vehicle, gains,
        strategy, rate, start, FOREVER if end is None else end,
    )  # fmt: skip
    flight = open_flight(order.bag, robot)
    target = resolve_folder(out, 'replay')
    # ns to s; a damaged bag may have no times
    span = ((flight.bag.end or 0) - (flight.bag.start or 0)) * 1e-9
    with ReplayProgress(console, max(0.0, min(span, order.end) - start)) as progress:
        played = run_replay(order, flight, target, progress)
    verdict = (
        compare_with_recording(flight, open_flight(played.bag), order.node_selection.answers)
        if against
        else None
    )
    write_results(played, verdict, order, flight, target, console, json)
    # Without --against, only an incomplete replay is a failure
    if not played.is_complete or (verdict is not None and verdict.word == 'different'):
        raise typer.Exit(1)


def write_results(
    played: ReplayRun,
    verdict: ReplayVerdict | None,
    order: ReplayRequest,
    flight: RecordedFlight,
    target: Path,
    console: Console,
    json: bool,
) -> None:
    """Write the results, and print a summary and their paths."""
    content = {
        'bag': str(played.bag),
        'whole': played.is_complete,
        'player': played.standing,
        'changes': order.changes,
        **(verdict.to_dict() if verdict else {}),
    }
    page = None
    if verdict is not None:
        page = write_page(verdict, order, flight.provenance, target)
        content['page'] = str(page)
    written = write_json(content, target / 'replay.json')
    if json:
        sys.stdout.write(written)
    if not played.is_complete:
        console.print('The replay stopped before the end of the recording.', highlight=False)
    elif played.standing is not None:
        status = played.standing
        console.print(
            f'Replayed {status["time_s"]} s at {status["pace"]} x real time: '
            f'{status["messages"]} messages played, {status["answers"]} output messages.',
            highlight=False,
        )
    if verdict is not None:
        print_verdict(verdict, console)
    console.print(
        f'Bag  {relative_path(played.bag)}', highlight=False, markup=False, soft_wrap=True
    )
    if page is not None:
        console.print(
            format_page_line(relative_path(page)), highlight=False, markup=False, soft_wrap=True
        )


def print_verdict(verdict: ReplayVerdict, console: Console) -> None:
    """Print the verdict, the differing fields and the changed decisions."""
    console.print(f'{verdict.sentence}.', highlight=False, soft_wrap=True)
    printed = Table(
        Column('topic', overflow='fold'), Column('field', overflow='fold'),
        'differs', 'first', 'recorded', 'replayed', 'largest', box=None,
    )  # fmt: skip
    for topic in verdict.topics:
        # The channels are sorted by the time of their first difference
        for each in topic.channels[:WORST]:
            # Time of the first difference since the start of the flight [s]
            at = verdict.relative_time(int(topic.recorded.keys[each.first]))
            printed.add_row(
                topic.topic, each.path, f'{each.count}/{topic.count}', f'{at:.2f} s',
                # Seven digits: enough to show differences of single-precision numbers
                *(format_value(value, 7) for value in (each.recorded, each.again, each.largest)),
            )  # fmt: skip
    if printed.row_count:
        console.print(printed)
    for decision in verdict.decisions:
        if decision.first_change is not None:
            at = verdict.relative_time(int(decision.keys[decision.first_change]))
            how = f', {format_largest_change(decision)}' if decision.unit else ''
            console.print(
                f'{decision.name}: {decision.change_count} of {len(decision.keys)} decisions '
                f'differ from the recording, first at {at:.2f} s{how}.',
                highlight=False,
            )
    for topic in verdict.topics:
        if any(topic.unmatched):
            console.print(
                f'{topic.topic}: {topic.unmatched[0]} recorded and {topic.unmatched[1]} replayed '
                'messages have no counterpart and were not compared.',
                highlight=False,
            )
