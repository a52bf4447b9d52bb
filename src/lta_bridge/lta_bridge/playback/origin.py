"""Provenance of replays: the recording's origin, and the nodes that were run again."""

from collections.abc import Mapping

from lta_bridge.playback.recording import RobotBagRecording
from lta_bridge.provenance import describe_environment

REPLAY_OF, REPLAYED = 'replay_of', 'replayed_nodes'  # keys of the origin
# Keys copied from the recording
SCENE = ('scenario', 'scenario_file', 'seed', 'offset_x', 'offset_y')
OWN = 'strategy_file'  # a replay may fly another strategy, which is no file
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
    original = {key: value for key, value in recording.provenance.items() if key not in (SET, OWN)}
    runs = {key: value for key, value in graph.items() if key not in SCENE}
    return {**original, **runs, REPLAY_OF: str(recording.path)}
