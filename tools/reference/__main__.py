# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Print one reference page: `make reference`."""

from importlib import import_module
import sys

from lta_config.errors import BadInput, unknown_name_error

PAGES = {  # page name to path below docs/, as `make reference` writes them
    'topics': 'topics.md',
    'effects': 'effects.md',
    'verbs': 'verbs.md',
    'parameters': 'parameters.md',
    'vehicles': 'vehicles.md',
    'vehicle_keys': 'vehicle_keys.md',
    'graph': 'images/graph.svg',
}


def render_page(name: str) -> str:
    """Return the text of a page; raise `BadInput` if the name is unknown."""
    if name not in PAGES:
        raise unknown_name_error('page of the reference', name, list(PAGES))
    # Import only the requested page: the page of parameters loads the ROS nodes
    module = import_module(f'tools.reference.{name}')
    text: str = module.render_page()
    return text


if __name__ == '__main__':
    try:
        sys.stdout.write(render_page(' '.join(sys.argv[1:])))
    except BadInput as error:
        sys.exit(f'{error}')
