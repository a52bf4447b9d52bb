# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Write the nodes' answers of a replay to a bag, each logged at its due time.

A storage fault ends the bag but not the replay; the player reports it when it closes.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
import time
from typing import final

from lta_bag.background_writer import FLUSH_PERIOD
from lta_bag.metadata import build_offered_qos
from lta_bag.provenance import describe_environment
from lta_bag.storage import StorageFault
from lta_bag.writer import BagWriter
from lta_bridge.log_time_assigner import read_stamp
from lta_bridge.playback.node_selection import NodeSelection
from lta_bridge.playback.recording import RobotBagRecording
from lta_config.errors import BadInput
from lta_config.topics import robot_topic, TopicTable
from lta_graph.quality import select_quality

REPLAY_OF, REPLAYED = 'replay_of', 'replayed_nodes'  # keys of the origin
# Keys copied from the recording
SCENE_KEYS = ('scenario', 'scenario_file', 'seed', 'offset_x', 'offset_y')
STRATEGY_KEY = 'strategy_file'  # a replay may fly another strategy, which is no file
SET = 'set'  # parameters of the flight; only `lta replay` passes them to the nodes again


def build_answers_origin(recording: RobotBagRecording, nodes: tuple[str, ...]) -> dict[str, str]:
    """Return the provenance of a bag with some nodes' answers to a recording."""
    replay = {REPLAY_OF: str(recording.path), REPLAYED: ' '.join(nodes)}
    return {**recording.provenance, **describe_environment(), **replay}


def build_replay_origin(recording: RobotBagRecording, graph: Mapping[str, str]) -> dict[str, str]:
    """
    Return the provenance of a bag recorded from a graph during a replay.

    `recording`: the replayed recording: origin of scene, seed, and whether the data were measured.
    `graph`: provenance of the launch: vehicle, gains and strategy of the running nodes.
    """
    original = {
        key: value for key, value in recording.provenance.items() if key not in (SET, STRATEGY_KEY)
    }
    runs = {key: value for key, value in graph.items() if key not in SCENE_KEYS}
    return {**original, **runs, REPLAY_OF: str(recording.path)}


@final
class AnswerBag:
    """
    Write answers to a bag; call `close` at the end.

    Parameters
    ----------
    path : Path or None
        Folder of the bag; it must be empty or not exist yet. None writes no bag.
    recording : Recording
        The played recording, whose origin is stored in the bag.
    selection : NodeSelection
        The nodes that answer.
    table : TopicTable
        Types and latencies.
    robot : str
        Namespace of the nodes.
    lockstep : bool
        Whether they run in lockstep, for their QoS profiles.

    Attributes
    ----------
    fault : str
        Why nothing more is written; empty without a fault.

    Raises
    ------
    BadInput
        If the bag cannot be created.

    """

    def __init__(
        self,
        path: Path | None,
        recording: RobotBagRecording,
        selection: NodeSelection,
        table: TopicTable,
        robot: str,
        lockstep: bool,
    ) -> None:
        self._table = table
        self._names: Mapping[str, str] = {
            name: robot_topic(robot, name) for name in selection.answers
        }
        self.fault = ''
        self._flushed = time.monotonic()
        self._writer: BagWriter | None = None
        if path is None:
            return
        try:
            self._writer = BagWriter(path, build_answers_origin(recording, selection.nodes))
            for name, full in self._names.items():
                depth, reliability, durability = select_quality(table[name], lockstep)
                offered = [build_offered_qos(reliability, durability, depth)]
                self._writer.add_topic(full, table[name].type, offered)
        except StorageFault as fault:
            raise BadInput(str(fault)) from None

    def write(self, name: str, data: bytes, due_ns: int | None, now_ns: int) -> None:
        """
        Write an answer to a relative topic.

        `due_ns` is its due time if known, `now_ns` the bag's present time for unstamped messages.
        """
        if self._writer is None:
            return
        when, writer = due_ns, self._writer
        if when is None:
            row = self._table[name]
            stamp = read_stamp(data) if row.stamped else None
            # As a recorder does, so that both bags can be compared
            when = now_ns if stamp is None else stamp + row.latency_ns
        self._try_step(lambda: writer.write(self._names[name], data, when))

    def flush(self) -> None:
        """Flush the bag, if that is due."""
        if self._writer is not None and time.monotonic() - self._flushed >= FLUSH_PERIOD:
            self._try_step(self._writer.flush)
            self._flushed = time.monotonic()

    def close(self) -> None:
        """Finish the bag."""
        # Even after a fault: closing makes the messages so far readable
        if self._writer is not None:
            self._try_step(self._writer.close, always=True)

    def _try_step(self, step: Callable[[], None], *, always: bool = False) -> None:
        """Run a step unless the disk has failed; keep the first fault."""
        if self.fault and not always:
            return
        try:
            step()
        except StorageFault as fault:
            self.fault = self.fault or str(fault)
