"""The page of a flight: results, pictures, and one HTML file that holds them all."""

from lta_flight.report.page import write_page
from lta_flight.report.results import FlightResults

__all__ = ['FlightResults', 'write_page']
