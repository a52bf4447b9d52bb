# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""README and the tutorials work word for word, in a copy of the working tree."""

import shutil

from doc_blocks import FOLLOWED
from followed_pages import copy_tree, is_said, Quoted, steps, Typed, Written
import pytest

FLIGHTS = 'ABCD'  # the flights of one's own that README names


@pytest.fixture(scope='module')
def tree(tmp_path_factory):
    return copy_tree(tmp_path_factory.mktemp('clone'))


@pytest.mark.long
@pytest.mark.parametrize('page', FOLLOWED)
def test_a_page_is_followed(page, tree):
    tree.reset()
    if page == 'README.md':
        for seed, name in enumerate(FLIGHTS, 1):
            tree.run(f'./lta simulate --seed {seed} --out {name}')
    todo = steps(page)
    for step in todo:
        step.do(tree)
    for name in FLIGHTS:
        shutil.rmtree(tree.folder / name, ignore_errors=True)
    assert set(tree.untracked()) <= {step.path for step in todo if isinstance(step, Written)}


def test_pages_have_steps_and_tutorials_show_what_they_print():
    assert len(FOLLOWED) == 11
    silent = {
        page
        for page in FOLLOWED
        if not any(isinstance(step, Quoted) for step in steps(page))
        and any(isinstance(step, Typed) for step in steps(page))
    }
    assert silent == {'README.md'}


@pytest.mark.parametrize(
    ('shown', 'said', 'expected'),
    [
        ('It is 3.3 cm off.', 'so\nIt is 3.4\n cm off. so', True),
        ('It is 3.3 cm off.', 'It is 3.5 cm off.', False),
        ('It is 12 cm off.', 'It is 11 cm off.', True),
        ('It is 12 cm off.', 'It is 12 cm.', False),
    ],
)
def test_numbers_may_differ_in_their_last_digit(shown, said, expected):
    assert is_said(shown, said) is expected
