"""
Write measured and forecast poses into one bag, to overlay them in Foxglove.

Each flight and model has its own topic, so that a viewer draws it as one line.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
import re
from tempfile import TemporaryDirectory
from typing import Any, Final

from lta_bridge.bag.metadata import build_offered_qos
from lta_bridge.bag.schemas import encode_message
from lta_bridge.bag.writer import BagWriter
from lta_discovery.discovery.figures import predict_poses
from lta_discovery.discovery.forecast_comparison import ForecastComparison
from lta_discovery.discovery.messages import build_offset_message, build_pose_message, SECOND_NS
from lta_discovery.flights.measured_flight import MeasuredFlight
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Row = tuple[int, str, Any]

OVERLAY_FILE: Final = 'overlay.mcap'
POSE_TYPE: Final = 'nav_msgs/msg/Odometry'
ERROR: Final = 'geometry_msgs/msg/Vector3Stamped'


def build_overlay(comparison: ForecastComparison, origin: Mapping[str, str]) -> bytes:
    """
    Return a bag of the judged flights: measured, and forecast by each model at the main horizon.

    `origin`: metadata of the bag.
    """
    rows = list(_list_messages(comparison))
    kinds = {topic: ERROR if topic.endswith('/error') else POSE_TYPE for _, topic, _ in rows}
    qos = [build_offered_qos('reliable', 'volatile', 10)]
    with TemporaryDirectory(prefix='lta-overlay-') as scratch:
        folder = Path(scratch) / 'overlay'
        with BagWriter(folder, origin) as writer:
            for topic, kind in kinds.items():
                writer.add_topic(topic, kind, qos)
            for time_ns, topic, message in sorted(rows, key=lambda row: row[:2]):
                writer.write(topic, encode_message(message, kinds[topic]), time_ns)
        (only,) = folder.glob('*.mcap')
        return only.read_bytes()


def _list_messages(comparison: ForecastComparison) -> Iterator[Row]:
    """Yield times [ns], topics and messages of all flights."""
    main = comparison.main
    words = format_topic_names(comparison.names)
    for k, (word, flight) in enumerate(zip(words, comparison.flights, strict=True)):
        poses = np.column_stack([flight.position, flight.quaternion])
        yield from _list_poses(f'/{word}/measured', flight.time, poses)
        if main is None:
            continue
        for model, forecasts in comparison.forecasts.items():
            place = f'/{word}/{format_topic_name(model)}'
            time, forecast = predict_poses(flight, forecasts[k], main.horizon)
            yield from _list_poses(place, time, forecast)
            yield from _list_errors(f'{place}/error', flight, time, forecast)


def _list_poses(topic: str, time: Array, poses: Array) -> Iterator[Row]:
    """Yield the known poses, shape (n, 7), in the map."""
    for stamp, values in zip(time, poses, strict=True):
        if np.isfinite(values).all():
            time_ns = round(float(stamp) * SECOND_NS)
            # Each model has its own body frame
            yield time_ns, topic, build_pose_message(time_ns, values, topic.strip('/'))


def _list_errors(topic: str, flight: MeasuredFlight, time: Array, poses: Array) -> Iterator[Row]:
    """Yield the error of each forecast position, in the map. [m]"""
    at = np.searchsorted(flight.time, time - 1e-6)
    for stamp, offset in zip(time, poses[:, :3] - flight.position[at], strict=True):
        if np.isfinite(offset).all():
            time_ns = round(float(stamp) * SECOND_NS)
            yield time_ns, topic, build_offset_message(time_ns, offset)


def format_topic_name(name: str) -> str:
    """Return a name as a valid part of a topic name."""
    word = re.sub(r'\W+', '_', name, flags=re.ASCII).strip('_')
    return word if word[:1].isalpha() else f'flight_{word}'


def format_topic_names(names: tuple[str, ...]) -> list[str]:
    """Return the flights' names as distinct parts of topic names."""
    out: list[str] = []
    for name in names:
        word, count = format_topic_name(name), 1
        while word in out:
            count += 1
            word = f'{format_topic_name(name)}_{count}'
        out.append(word)
    return out
