"""lta replay: nodes run again on what was recorded, and compared with it."""

from pathlib import Path
import sys
from typing import Annotated

from lta_bridge.playback.settings import FOREVER
from lta_cli.options.json_option import Json
from lta_cli.options.out_option import folder
from lta_cli.options.plain_console import plain_console
from lta_config.typed import near
from lta_data.bag.flight import Flight, open_flight
from lta_data.bag.folder import bag_in
from lta_flight.replay.given import settings_of
from lta_flight.replay.order import nodes_of, Order
from lta_flight.replay.page import figure, largest, write_page
from lta_flight.replay.progress import ReplayProgress
from lta_flight.replay.run import replay as run_again
from lta_flight.replay.run import Replayed
from lta_flight.replay.verdict import judged, Verdict
from lta_report.results_folder import keep_json, page_line, results_folder
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
            parser=folder,
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
    names = nodes_of(nodes)
    order = Order(
        bag_in(bag).absolute(), names, settings_of(set_ or [], names), vehicle, gains, strategy,
        rate, start, FOREVER if end is None else end,
    )  # fmt: skip
    flight = open_flight(order.bag, robot)
    target = results_folder(out, 'replay')
    span = ((flight.bag.end or 0) - (flight.bag.start or 0)) * 1e-9
    with ReplayProgress(console, max(0.0, min(span, order.end) - start)) as progress:
        played = run_again(order, flight, target, progress)
    verdict = judged(flight, open_flight(played.bag), order.cast.answers) if against else None
    tell(played, verdict, order, flight, target, console, json)
    if not played.whole or (verdict is not None and verdict.word == 'different'):
        raise typer.Exit(1)


def tell(
    played: Replayed,
    verdict: Verdict | None,
    order: Order,
    flight: Flight,
    target: Path,
    console: Console,
    json: bool,
) -> None:
    """Write the results, and say what came out and where it is."""
    content = {
        'bag': str(played.bag),
        'whole': played.whole,
        'player': played.standing,
        'changes': order.changes,
        **(verdict.to_dict() if verdict else {}),
    }
    page = None
    if verdict is not None:
        page = write_page(verdict, order, flight.provenance, target)
        content['page'] = str(page)
    written = keep_json(content, target / 'replay.json')
    if json:
        sys.stdout.write(written)
    if not played.whole:
        console.print('The replay did not come to its end.', highlight=False)
    elif played.standing is not None:
        said = played.standing
        console.print(
            f'Replayed {said["time_s"]} s at {said["pace"]} x real time: {said["messages"]} '
            f'messages played, {said["answers"]} answers.',
            highlight=False,
        )
    if verdict is not None:
        show(verdict, console)
    console.print(f'Bag  {near(played.bag)}', highlight=False, markup=False, soft_wrap=True)
    if page is not None:
        console.print(page_line(near(page)), highlight=False, markup=False, soft_wrap=True)


def show(verdict: Verdict, console: Console) -> None:
    """Print the verdict, what differs, and which decisions changed."""
    console.print(f'{verdict.sentence}.', highlight=False, soft_wrap=True)
    printed = Table(
        Column('topic', overflow='fold'), Column('field', overflow='fold'),
        'differs', 'first', 'recorded', 'replayed', 'largest', box=None,
    )  # fmt: skip
    for topic in verdict.topics:
        for each in topic.channels[:WORST]:
            at = verdict.seconds(int(topic.recorded.keys[each.first]))
            printed.add_row(
                topic.topic, each.path, f'{each.count}/{topic.count}', f'{at:.2f} s',
                *(figure(value, 7) for value in (each.recorded, each.again, each.largest)),
            )  # fmt: skip
    if printed.row_count:
        console.print(printed)
    for decision in verdict.decisions:
        if decision.first is not None:
            at = verdict.seconds(int(decision.keys[decision.first]))
            how = f', {largest(decision)}' if decision.unit else ''
            console.print(
                f'{decision.name}: {decision.changed} of {len(decision.keys)} changed, first at '
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
