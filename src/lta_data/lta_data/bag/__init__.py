# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read recordings: bags, and flights as aligned arrays."""

from lta_data.bag.info import BagInfo, summarize_bag
from lta_data.bag.reader import Bag, read_bag
from lta_data.bag.recorded_flight import open_flight, RecordedFlight

__all__ = ['Bag', 'BagInfo', 'RecordedFlight', 'open_flight', 'read_bag', 'summarize_bag']
