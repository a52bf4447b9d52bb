"""lta replay: nodes run again on what was recorded, and compared with it."""

from pathlib import Path
import sys
from typing import Annotated

from lta_bridge.playback.settings import FOREVER
from lta_cli.options.json_option import Json
from lta_cli.options.out_option import parse_folder
from lta_cli.options.plain_console import plain_console
from lta_config.command_line import relative_path
from lta_data.bag.bag_folder import find_bag
from lta_data.bag.recorded_flight import open_flight, RecordedFlight
from lta_flight.replay.node_settings import parse_settings
from lta_flight.replay.page import format_largest_change, format_value, write_page
from lta_flight.replay.progress import ReplayProgress
from lta_flight.replay.request import parse_nodes, ReplayRequest
from lta_flight.replay.run import ReplayRun
from lta_flight.replay.run import run_replay as run_again
from lta_flight.replay.verdict import compare_flights, ReplayVerdict
from lta_report.results_folder import format_page_line, resolve_folder, write_json
from rich.console import Console
from rich.table import Column, Table
import typer

WORST = 3  # channels of a topic on the terminal


def replay(
    bag: Annotated[Path, typer.Argument(help='Bag folder, results folder or .mcap file.')],
    nodes: Annotated[
        str, typer.Option(help='Nodes to run again, with commas between.')
    ] = 'demodulator,navigator',
    against: Annotated[
        bool, typer.Option('--against', help='Compare every answer with the recorded one.')
    ] = False,
    set_: Annotated[
        list[str] | None,
        typer.Option('--set', help='NODE.PARAMETER=VALUE of a node that is run; repeatable.'),
    ] = None,
    strategy: Annotated[str | None, typer.Option(help='Another navigation strategy.')] = None,
    vehicle: Annotated[str | None, typer.Option(help='Another vehicle, name or file.')] = None,
    gains: Annotated[str | None, typer.Option(help='Other gains, name or file.')] = None,
    robot: Annotated[str | None, typer.Option(help='Robot in a bag of several.')] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            help='Bag seconds a wall second; without it, in lockstep.', min=1e-3, max=1e6
        ),
    ] = None,
    start: Annotated[float, typer.Option(help='Begin so many seconds later.', min=0.0)] = 0.0,
    end: Annotated[
        float | None, typer.Option(help='End so many seconds after the first message.', min=0.0)
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
    Run nodes again on a recording, and tell whether they decide as they did.

    The player publishes what was recorded, the nodes answer as fast as they can, and nothing is
    lost on the way. Vehicle, gains and strategy are those that the bag carries, unless others are
    given. What the other nodes of the graph sent is played from the bag as well.

    Exit status 0: done; with --against, identical to the last bit, or within 1e-9 and with the
    same decisions where the bag was made with other versions or on another machine. 1: different,
    or a node did not answer. 2: bad input. 130: Ctrl-C.

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
    span = ((flight.bag.end or 0) - (flight.bag.start or 0)) * 1e-9
    with ReplayProgress(console, max(0.0, min(span, order.end) - start)) as progress:
        played = run_again(order, flight, target, progress)
    verdict = (
        compare_flights(flight, open_flight(played.bag), order.node_selection.answers)
        if against
        else None
    )
    write_results(played, verdict, order, flight, target, console, json)
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
    """Write the results, and say what came out and where it is."""
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
        console.print('The replay did not come to its end.', highlight=False)
    elif played.standing is not None:
        said = played.standing
        console.print(
            f'Replayed {said["time_s"]} s at {said["pace"]} x real time: {said["messages"]} '
            f'messages played, {said["answers"]} answers.',
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
    """Print the verdict, what differs, and which decisions changed."""
    console.print(f'{verdict.sentence}.', highlight=False, soft_wrap=True)
    printed = Table(
        Column('topic', overflow='fold'), Column('field', overflow='fold'),
        'differs', 'first', 'recorded', 'replayed', 'largest', box=None,
    )  # fmt: skip
    for topic in verdict.topics:
        for each in topic.channels[:WORST]:
            at = verdict.relative_time(int(topic.recorded.keys[each.first]))
            printed.add_row(
                topic.topic, each.path, f'{each.count}/{topic.count}', f'{at:.2f} s',
                *(format_value(value, 7) for value in (each.recorded, each.again, each.largest)),
            )  # fmt: skip
    if printed.row_count:
        console.print(printed)
    for decision in verdict.decisions:
        if decision.first_change is not None:
            at = verdict.relative_time(int(decision.keys[decision.first_change]))
            how = f', {format_largest_change(decision)}' if decision.unit else ''
            console.print(
                f'{decision.name}: {decision.change_count} of {len(decision.keys)} changed, first '
                f'at '
                f'{at:.2f} s{how}.',
                highlight=False,
            )
    for topic in verdict.topics:
        if any(topic.unmatched):
            console.print(
                f'{topic.topic}: not compared are {topic.unmatched[0]} recorded and '
                f'{topic.unmatched[1]} replayed messages without a partner.',
                highlight=False,
            )
