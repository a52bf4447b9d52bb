# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Results, figures and HTML page of a flight."""

from lta_flight.report.page import write_page
from lta_flight.report.results import FlightResults

__all__ = ['FlightResults', 'write_page']
