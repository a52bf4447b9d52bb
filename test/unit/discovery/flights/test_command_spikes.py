# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Single impossible commands are clipped and counted; long ones stay."""

from lta_discovery.flights.measured_flight import FlightStreams, Stream
from lta_discovery.flights.outliers import clip_command_spikes
import numpy as np

TIME = np.arange(0.0, 20.0, 0.02)
POSE = Stream(TIME, np.zeros((len(TIME), 7)))


def test_a_spike_of_a_moment_is_clipped_to_the_largest_other_command() -> None:
    told = np.zeros((len(TIME), 6))
    told[:, 5] = 0.02 * np.sin(TIME)
    told[400, 5] = 0.88
    streams, count = clip_command_spikes(
        FlightStreams(POSE, Stream(TIME[:1], np.zeros((1, 4))), wrench=Stream(TIME, told))
    )
    assert count == 1
    assert streams.wrench is not None
    np.testing.assert_allclose(
        streams.wrench.values[400, 5], np.abs(np.delete(told[:, 5], 400)).max()
    )
    np.testing.assert_array_equal(np.delete(streams.wrench.values, 400, 0),
                                  np.delete(told, 400, 0))  # fmt: skip


def test_long_commands_stay_however_large() -> None:
    told = np.zeros((len(TIME), 6))
    told[:, 0] = 0.01 * np.cos(TIME)
    told[300:320, 0] = 0.2
    given = FlightStreams(POSE, Stream(TIME[:1], np.zeros((1, 4))), wrench=Stream(TIME, told))
    streams, count = clip_command_spikes(given)
    assert count == 0
    assert streams.wrench is given.wrench
