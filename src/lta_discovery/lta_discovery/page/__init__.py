"""The page of a study: one story, from what is missing to how much better the model is with it."""

from lta_discovery.page.page import write_page

__all__ = ['write_page']
