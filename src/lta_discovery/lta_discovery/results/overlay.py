"""
Write measured and predicted poses into one bag, to overlay them in Foxglove.

Each piece of a prediction starts at the measured state and runs without correction. Each flight
and model has its own topic, so that a viewer draws it as one line.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
import re
from typing import Any, Final

from lta_bridge.bag.qos import build_offered_qos
from lta_bridge.bag.writer import BagWriter
from lta_bridge.cdr import encode_message
from lta_discovery.flights.measured_flight import PERIOD
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import LinearizationPoint
from lta_discovery.replay.replay import STEPS
from lta_discovery.replay.sensing import predict_readings
from lta_discovery.results.messages import build_offset_message, build_pose_message, SECOND
from lta_discovery.study import ThreeModelComparison
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NAME: Final = 'overlay'
FILE: Final = 'overlay.mcap'
MODELS: Final = ('before', 'after')
KINDS: Final = {
    'measured': 'nav_msgs/msg/Odometry',
    'before': 'nav_msgs/msg/Odometry',
    'after': 'nav_msgs/msg/Odometry',
    'before/error': 'geometry_msgs/msg/Vector3Stamped',
    'after/error': 'geometry_msgs/msg/Vector3Stamped',
}
Row = tuple[int, str, Any]


def write_overlay(
    comparisons: Sequence[ThreeModelComparison], folder: Path, origin: Mapping[str, str]
) -> Path:
    """Write the overlay bag and return its file."""
    bag = folder / NAME
    qos = [build_offered_qos('reliable', 'volatile', 10)]
    words = format_topic_names([one.study_flight.name for one in comparisons])
    rows = [
        row
        for one, word in zip(comparisons, words, strict=True)
        for row in _list_messages(one, f'/{word}')
    ]
    with BagWriter(bag, origin) as writer:
        for word in words:
            for name, kind in KINDS.items():
                writer.add_topic(f'/{word}/{name}', kind, qos)
        for time_ns, topic, message in sorted(rows, key=lambda row: row[:2]):
            kind = KINDS[topic.split('/', 2)[2]]
            writer.write(topic, encode_message(message, kind), time_ns)
    # Viewers open a single .mcap file; the folder and its metadata are not needed.
    (only,) = bag.glob('*.mcap')
    target = only.rename(folder / FILE)
    (bag / 'metadata.yaml').unlink()
    bag.rmdir()
    return target


def format_topic_name(name: str) -> str:
    """Return a flight's name as a valid part of a topic name."""
    word = re.sub(r'\W+', '_', name, flags=re.ASCII).strip('_')
    return word if word[:1].isalpha() else f'flight_{word}'


def format_topic_names(names: Sequence[str]) -> list[str]:
    """Return the flights' names as distinct parts of topic names."""
    out: list[str] = []
    for name in names:
        word, count = format_topic_name(name), 1
        while word in out:
            count += 1
            word = f'{format_topic_name(name)}_{count}'
        out.append(word)
    return out


def predict_tracker_states(flight: FlightLinearizer, point: LinearizationPoint) -> Array:
    """Predict the pose that a tracker measures, and the velocities, shape (S, n, 13)."""
    # Zero the random part: a forecast must not use the initial states fitted to this flight.
    still = LinearizationPoint(point.nominal, point.values, np.zeros_like(point.random))
    states = flight.simulate_forecast(still)[:, ::STEPS]
    acting = flight.replay.build_replay_rows(point.nominal).acting
    seen = predict_readings(states, flight.time, acting, flight.places)
    return np.concatenate([seen.position, seen.quaternion, states[:, :-1, 7:13]], axis=-1)


def _list_messages(one: ThreeModelComparison, place: str) -> list[Row]:
    """Return the messages of one flight with their times and topics."""
    flight = one.study_flight.flight
    measured = flight.replay.flight
    valid = np.isfinite(measured.position).all(axis=1)
    rows: list[Row] = []
    for k in np.flatnonzero(valid):
        time_ns = round(float(measured.time[0]) * SECOND) + int(k) * round(PERIOD * SECOND)
        still = np.zeros(6)
        values = np.concatenate([measured.position[k], measured.quaternion[k], still])
        rows.append(
            (time_ns, f'{place}/measured', build_pose_message(time_ns, values, 'measured'))
        )
    for name in MODELS:
        rows += _list_model_messages(
            flight, predict_tracker_states(flight, getattr(one, name)), name, place
        )
    return rows


def _list_model_messages(
    flight: FlightLinearizer, states: Array, name: str, place: str
) -> list[Row]:
    measured, inside = flight.replay.flight, flight.replay.cut.inside
    start = round(float(measured.time[0]) * SECOND)
    rows: list[Row] = []
    for piece, index in zip(*np.nonzero(inside), strict=True):
        at = flight.index[piece, index]
        values = states[piece, index]
        if not np.isfinite(values).all() or abs(values).max() > 1e6:
            continue  # skip a diverged prediction
        time_ns = start + int(at) * round(PERIOD * SECOND)
        rows.append((time_ns, f'{place}/{name}', build_pose_message(time_ns, values, name)))
        off = values[:3] - measured.position[at]
        if np.isfinite(off).all():
            rows.append((time_ns, f'{place}/{name}/error', build_offset_message(time_ns, off)))
    return rows
