"""Select two blocks of samples for figures: the first and the last of the search."""

from typing import Final, NamedTuple

from lta_config.topics import load_topic_table
from lta_flight.report.results import find_phases
from lta_flight.report.view import FlightView
from lta_report.curves import Array, interpolate
from lta_report.palette import ESTIMATE, TRUTH
import numpy as np

COLOURS: Final = (TRUTH, ESTIMATE)


class SampleBlock(NamedTuple):
    """Samples over time of one diode in a block, and a label with the place."""

    where: str
    colour: str
    time: Array  # in the block [s]
    samples: Array  # [counts]


def select_sample_blocks(view: FlightView) -> list[SampleBlock]:
    """Return the blocks at the start and at the end of the search."""
    time = view.read_series('photodiodes').time
    phases = find_phases(view)
    searched = np.flatnonzero(
        # A block must lie within the search as a whole
        (time >= phases.search) & (time <= phases.end - 2 * view.half_block_time)
    )
    # A flight without a search shows the ends of the recording
    chosen = searched if len(searched) else np.arange(len(time))
    rate = load_topic_table().light.sample_rate.si
    blocks = []
    ends = (int(chosen[0]), int(chosen[-1]))
    for k, samples, colour in zip(ends, view.read_blocks(ends), COLOURS, strict=True):
        block = samples.astype(np.float64)
        # The lamp modulates the light, so its diode has the largest deviation
        brightest = block[:, block.std(axis=0).argmax()]
        blocks.append(
            SampleBlock(
                format_lamp_distance(view, float(time[k])),
                colour,
                np.arange(len(block)) / rate,
                brightest,
            )
        )
    return blocks


def format_lamp_distance(view: FlightView, time: float) -> str:
    """Return the distance of the drone from the lamp, in words."""
    if not view.goal.places or not view.has_topics('ground_truth/odom'):
        return f'at {time:.1f} s'
    away = view.goal.lamp_distance(view.truth)
    return f'{float(interpolate(np.array([time]), view.truth.time, away)[0]):.1f} m from the lamp'
