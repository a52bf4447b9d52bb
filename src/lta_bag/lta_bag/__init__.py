# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Write crash-safe rosbag2 recordings in the MCAP format, and read what is left of any."""

from lta_bag.metadata import build_offered_qos, OfferedQos
from lta_bag.storage import free_space, StorageFault
from lta_bag.writer import BagWriter

__all__ = ['BagWriter', 'OfferedQos', 'StorageFault', 'build_offered_qos', 'free_space']
