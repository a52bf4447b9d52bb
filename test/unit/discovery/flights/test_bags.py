"""Bags get a name and a role, each once."""

import shutil

from lta_config.errors import BadInput
from lta_discovery.flights.bags import read_bags
import pytest


def test_bags_keep_their_names_roles_and_order(hidden_bags, tmp_path):
    a, b, c = hidden_bags
    results = tmp_path / 'flown'
    shutil.copytree(c, results / 'bag')  # as the results folder of a flight has it
    again = tmp_path / 'A'
    shutil.copytree(b, again)
    told = []
    found = read_bags({'holdout': [results], 'train': [a, again]}, tell=told.append)
    assert [(one.name, one.role) for one in found] == [
        ('A', 'train'), ('A_2', 'train'), ('flown', 'holdout'),
    ]  # fmt: skip
    assert told == ['A', 'A_2', 'flown']
    assert {one.vehicle for one in found} == {'gtmab'}
    assert found[0].rotor_names == ('forward_left', 'forward_right', 'up_left', 'up_right')
    assert found[0].recording.is_simulated


@pytest.mark.parametrize('role', ['train', 'confirm'])
def test_a_bag_has_one_role(hidden_bags, role):
    a = hidden_bags[0]
    (file,) = a.glob('*.mcap')  # the same in other words
    with pytest.raises(BadInput, match='is given twice'):
        read_bags({'train': [a, *([file] if role == 'train' else [])],
                   **({role: [file]} if role != 'train' else {})})  # fmt: skip


def test_there_has_to_be_something_to_learn_from(hidden_bags):
    with pytest.raises(BadInput, match='no training flight'):
        read_bags({'confirm': [hidden_bags[0]]})


def test_what_is_no_bag_is_said(tmp_path):
    with pytest.raises(BadInput, match='does not exist'):
        read_bags({'train': [tmp_path / 'nothing']})
