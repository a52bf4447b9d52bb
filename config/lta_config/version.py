"""The version of LTA: here; setup.py, package.xml and CITATION.cff repeat it, held by a test."""

from typing import Final

VERSION: Final = '1.0.0'
