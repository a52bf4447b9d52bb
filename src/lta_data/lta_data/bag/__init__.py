# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Read recordings as flights: aligned arrays with units."""

from lta_data.bag.info import BagInfo, summarize_bag
from lta_data.bag.recorded_flight import open_flight, RecordedFlight

__all__ = ['BagInfo', 'RecordedFlight', 'open_flight', 'summarize_bag']
