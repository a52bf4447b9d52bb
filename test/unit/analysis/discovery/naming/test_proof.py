"""A name gives way to another that explains more, whether they look alike or not."""

from types import SimpleNamespace
from unittest import mock

from lta_analysis.discovery.naming.proof import Proof
import pytest


@pytest.mark.parametrize(
    ('linear', 'alike', 'refitted', 'named', 'others'),
    [
        (104.2, True, 108.0, 'other', {}),  # alike, but better by more than a tie
        (104.2, True, 102.0, 'name', {'other': True}),  # promised and not kept
        (102.9, True, 108.0, 'name', {'other': True}),  # another word for it: never refitted
        (96.9, True, 108.0, 'name', {}),
        (96.0, False, 104.0, 'other', {}),
        (96.0, False, 98.0, 'name', {'other': False}),
    ],
)
def test_the_better_of_two_names_stands(
    linear: float, alike: bool, refitted: float, named: str, others: dict[str, bool]
) -> None:
    proof = object.__new__(Proof)
    full, then = SimpleNamespace(evidence=100.0), SimpleNamespace(evidence=refitted)
    near = mock.patch.object(Proof, '_near', return_value={'other': (linear, alike)})
    with near, mock.patch.object(Proof, '_changed', return_value=then):
        found, fitted, name = proof._swapped('name', ('name',), full)
    assert name == named
    assert fitted is (then if named == 'other' else full)
    assert found == others
