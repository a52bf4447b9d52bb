"""The version of LTA; a test compares setup.py, package.xml and CITATION.cff with it."""

from typing import Final

VERSION: Final = '1.0.0'
