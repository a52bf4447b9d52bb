"""Puts the tests' own tools on the path: imported before any of them."""

from pathlib import Path
import sys

TESTS = Path(__file__).resolve().parents[1]
sys.path += [str(TESTS), str(TESTS / 'integration')]
