"""One replay: its processes started, watched and put away."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
import json
from pathlib import Path
from typing import final, Protocol

from lta_bridge.bag.writer import empty_folder
from lta_config.errors import BadInput
from lta_data.bag.flight import Flight
from lta_flight.blame import Lookout, PLAYBACK
from lta_flight.domain_lock import DomainLock
from lta_flight.flight import refused
from lta_flight.replay.order import check, Order, plan_of
from lta_graph.child import Ended
from lta_graph.launcher import Launcher
from lta_graph.ros.listener import DiagnosticsListener

PATIENCE = 15.0  # wall seconds that the graph may stand still before the replay is given up
LOOK = 0.05  # wall seconds between looks at the processes and the diagnostics


class Watcher(Protocol):
    """Whoever shows the replay to a person."""

    def at(self, time: float, pace: float) -> None:
        """Show how far it is: bag time [s], and bag seconds a wall second."""
        ...

    def say(self, sentence: str) -> None:
        """Tell something that happened."""
        ...


@final
@dataclass(frozen=True, slots=True)
class Replayed:
    """
    How a replay went.

    Attributes
    ----------
    bag : Path
        What the nodes answered.
    standing : dict of str to str or None
        The player's last word; None where the graph broke.

    """

    bag: Path
    standing: dict[str, str] | None

    @property
    def whole(self) -> bool:
        """Whether the recording was played to its end."""
        return self.standing is not None and self.standing['outcome'] == 'played'


def replay(order: Order, flight: Flight, folder: Path, watcher: Watcher) -> Replayed:
    """
    Run nodes again on a recording.

    Parameters
    ----------
    order : Order
        What is asked for.
    flight : Flight
        The recording.
    folder : Path
        Where the results go; made, and refused if it holds anything.
    watcher : Watcher
        Who is shown how it goes.

    Raises
    ------
    BadInput
        If it cannot be replayed.

    """
    check(order, flight)
    empty_folder(folder)
    plan = plan_of(order, flight, folder)
    robot = plan.namespaces[0]
    with (
        DomainLock(robot),
        DiagnosticsListener(robot) as listener,
        Launcher(plan, on_line=lambda _name, _line: None) as launcher,
    ):
        watch(launcher, listener, watcher)
    return judged(folder / 'bag', launcher, watcher)


def watch(launcher: Launcher, listener: DiagnosticsListener, watcher: Watcher) -> None:
    """Follow a replay until a process ends it, or the graph has stood still for too long."""
    lookout = Lookout(watcher.say, listener.tell)
    while launcher.outcome is None:
        facts = listener.poll(LOOK)
        launcher.poll()
        fact = facts.get(PLAYBACK)
        if fact is not None and (told := fact.numbers('time_s', 'pace')):
            watcher.at(*told)
        running = launcher.running
        lookout.look(facts, listener.silent(running), listener.unheard(running))
        if lookout.standing > PATIENCE:
            watcher.say(f'The graph has stood still for {PATIENCE:.0f} s and is stopped.')
            return


def judged(bag: Path, launcher: Launcher, watcher: Watcher) -> Replayed:
    """Return how the replay went, from how its processes ended; a refusal is a `BadInput`."""
    end = launcher.outcome
    broken = end is None or not end.success
    for item in launcher.ended:
        if not item.status or (broken and item.stopped):
            continue
        if refused(item):
            raise BadInput(item.lines[-1])
        watcher.say('\n'.join((f'{item.sentence}.', *item.lines)))
    return Replayed(bag, None if broken else last_word(launcher.ended))


def last_word(ended: Iterable[Ended]) -> dict[str, str] | None:
    """Return the player's last word, None where it died without one."""
    for item in ended:
        if item.name == 'player' and item.stdout:
            with suppress(ValueError):
                said = json.loads(item.stdout[-1])
                return said if isinstance(said, dict) else None
    return None
