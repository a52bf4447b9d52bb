"""Write the HTML page of a study: missing effects, evidence, and gain in prediction accuracy."""

from lta_discovery.page.page import write_page

__all__ = ['write_page']
