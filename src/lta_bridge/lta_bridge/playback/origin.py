"""What a bag of answers says of its origin: the recording's own, and who answered it anew."""

from collections.abc import Mapping

from lta_bridge.playback.recording import BagRecording
from lta_bridge.provenance import describe_environment

REPLAY_OF, REPLAYED = 'replay_of', 'replayed_nodes'  # keys of the origin
SCENE = ('scenario', 'scenario_file', 'seed', 'offset_x', 'offset_y')  # as it was recorded
SET = 'set'  # parameters of the flight, which `lta replay` alone gives to the nodes again


def build_answers_origin(recording: BagRecording, nodes: tuple[str, ...]) -> dict[str, str]:
    """Return the origin of what some nodes answer to a recording, with its own parameters."""
    told = {REPLAY_OF: str(recording.path), REPLAYED: ' '.join(nodes)}
    return {**recording.provenance, **describe_environment(), **told}


def build_replay_origin(recording: BagRecording, graph: Mapping[str, str]) -> dict[str, str]:
    """
    Return the origin of a whole graph that is recorded while a recording is played to it.

    Parameters
    ----------
    recording : Recording
        What is played: scene, chance and whether it was measured are its own.
    graph : mapping of str to str
        The origin by the launch: vehicle, gains and strategy of the nodes that run.

    """
    kept = {key: value for key, value in recording.provenance.items() if key != SET}
    runs = {key: value for key, value in graph.items() if key not in SCENE}
    return {**kept, **runs, REPLAY_OF: str(recording.path)}
