"""Share data between the checks of one recording, computed on first use."""

from functools import cached_property
from typing import final

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import VehicleFile
from lta_data.data_quality.motion import (
    collect_inertials,
    collect_poses,
    InertialSeries,
    PoseSeries,
)
from lta_data.data_quality.motion_pairs import find_motion_pairs, MotionPair
from lta_data.data_quality.pair_similarity import measure_similarity, PairSimilarity
from lta_data.data_quality.recording import ChannelRecording
from lta_data.scene import parse_provenance_file


@final
class CheckContext:
    """A recording with the derived data that several checks use."""

    def __init__(self, recording: ChannelRecording) -> None:
        self.recording = recording

    @cached_property
    def poses(self) -> list[PoseSeries]:
        """Topics with the motion of the vehicle, trackers first."""
        return collect_poses(self.recording.channels)

    @cached_property
    def inertials(self) -> list[InertialSeries]:
        """Inertial sensors."""
        return collect_inertials(self.recording.channels)

    @cached_property
    def adc_full_scale(self) -> float | None:
        """Largest reading of the diodes' ADC; None without a vehicle file. [counts]"""
        try:
            vehicle = parse_provenance_file(VehicleFile, self.recording.provenance, 'vehicle_file')
        except BadInput:  # file of another version; the other checks still work
            return None
        return vehicle.sensors.diodes.largest_reading if vehicle else None

    @cached_property
    def pair_similarities(self) -> list[tuple[MotionPair, PairSimilarity | None]]:
        """Pairs of sources for the same motion, with their similarity."""
        pairs = find_motion_pairs(self.recording)
        return [(pair, measure_similarity(pair)) for pair in pairs]
