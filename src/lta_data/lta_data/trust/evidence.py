"""What several checks share of one recording, worked out once and only when asked for."""

from functools import cached_property
from typing import final

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import VehicleFile
from lta_data.scene import parsed
from lta_data.trust.likeness import Likeness, likeness
from lta_data.trust.limits import Limits
from lta_data.trust.motion import Inertial, inertials, Pose, poses
from lta_data.trust.pairs import Pair, pairs
from lta_data.trust.recording import Recording


@final
class Evidence:
    """
    A recording as the checks see it.

    Parameters
    ----------
    recording : Recording
        The data.
    limits : Limits
        The thresholds.

    """

    def __init__(self, recording: Recording, limits: Limits) -> None:
        self.recording = recording
        self.limits = limits

    @cached_property
    def poses(self) -> list[Pose]:
        """Topics that tell a motion of the vehicle, trackers first."""
        return poses(self.recording.channels)

    @cached_property
    def inertials(self) -> list[Inertial]:
        """Inertial sensors."""
        return inertials(self.recording.channels)

    @cached_property
    def top(self) -> float | None:
        """Largest reading of the diodes' converter; None where no vehicle file tells. [counts]"""
        try:
            vehicle = parsed(VehicleFile, self.recording.provenance, 'vehicle_file')
        except BadInput:  # of another version: its flight can still be checked
            return None
        return vehicle.sensors.diodes.top if vehicle else None

    @cached_property
    def likenesses(self) -> list[tuple[Pair, Likeness | None]]:
        """Motions known twice, and how their sides are alike."""
        found = pairs(self.recording, self.limits)
        return [(pair, likeness(pair, self.limits)) for pair in found]
