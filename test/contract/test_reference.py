# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The pages of the reference are those that the declarations make."""

from pathlib import Path

from lta_cli.app import VERBS
from lta_config.errors import BadInput
from lta_config.files import list_shipped_names
import pytest
from tools.reference.__main__ import PAGES, render_page

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize('name', PAGES)
def test_a_page_is_as_fresh_as_its_declarations(name):
    shipped = (ROOT / 'docs' / PAGES[name]).read_text(encoding='utf-8')
    assert shipped == render_page(name), 'run make reference'


def test_every_verb_vehicle_and_node_has_its_place():
    verbs, vehicles, parameters = (
        render_page(name) for name in ('verbs', 'vehicles', 'parameters')
    )
    assert all(f'# lta {name}\n' in verbs for name in VERBS)
    assert all(f'\n## {name}\n' in vehicles for name in list_shipped_names('vehicles'))
    nodes = [path for path in ROOT.glob('src/*/lta_*/nodes/*.py') if path.stem != '__init__']
    assert nodes
    assert all(f'\n## {node.parts[-3]} {node.stem}\n' in parameters for node in nodes)


def test_a_page_that_is_not_there_is_refused():
    with pytest.raises(BadInput, match=r"'verb'.*verbs"):
        render_page('verb')
