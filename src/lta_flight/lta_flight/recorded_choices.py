# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Read what a recording says was flown: strategy, vehicle, scenario and settings of nodes.

A recording may come from anybody. Its numbers and the names of what LTA ships may act. Whatever
names a file or a module never does: a strategy would be run, and another file would be opened
because a stranger chose it.
"""

from collections.abc import Collection, Mapping
from typing import Any, Final, NamedTuple

from lta_config.errors import BadInput
from lta_config.files import KIND_FOLDERS, list_shipped_names, validate_content
from lta_config.parameter_override import get_parameter, parse_assignment, replace_parameter
from lta_config.settings import Settings
from lta_control.estimator import EstimatorSettings
from lta_control.guidance import ReserveResponseSettings
from lta_control.mission import MissionSettings
from lta_control.strategies import STRATEGIES
from lta_energy.monitoring.monitor import MonitorSettings
from lta_vlc.lamp import LampPrior
from lta_vlc.settings import DemodulationSettings


class SettableBlock(NamedTuple):
    """Settings of a node that a flight may change: none of them names a file."""

    node: str
    prefix: str  # of the names of its parameters
    model: type[Settings]


SETTABLE: Final = {  # by the first word of a path in `lta simulate --set`
    'mission': SettableBlock('navigator', '', MissionSettings),
    'reserve': SettableBlock('navigator', 'reserve.', ReserveResponseSettings),
    'estimator': SettableBlock('estimator', '', EstimatorSettings),
    'demodulator': SettableBlock('demodulator', '', DemodulationSettings),
    'prior': SettableBlock('demodulator', 'prior.', LampPrior),
    'energy_monitor': SettableBlock('energy_monitor', '', MonitorSettings),
}


def find_recorded_name(provenance: Mapping[str, str], kind: str) -> str | None:
    """
    Return the recorded strategy, vehicle or scenario; None if none is recorded.

    `kind`: 'strategy', or a key of `FOLDERS`. Raise `BadInput` if it is not one of LTA's own.
    """
    name = provenance.get(kind)
    own: Collection[str] = (
        STRATEGIES if kind == 'strategy' else list_shipped_names(KIND_FOLDERS[kind])
    )
    if not name or (name in own and not (kind == 'strategy' and 'strategy_file' in provenance)):
        return name or None
    raise BadInput(
        f"The recording names the {kind} '{name}', which is not one of LTA's own, and nothing "
        f'is opened or run because a recording names it; give it with --{kind}.'
    )


def read_recorded_settings(
    provenance: Mapping[str, str], nodes: Collection[str]
) -> dict[str, dict[str, Any]]:
    """
    Return the parameters of nodes that were set for a flight in one process, by node.

    Raise `BadInput` for one that `lta simulate --set` could not have set.
    """
    settings: dict[str, dict[str, Any]] = {}
    # `lta simulate` joins its changes with '; '
    for text in filter(None, provenance.get('set', '').split('; ')):
        root, _, path = text.partition('=')[0].strip().partition('.')
        # Those of vehicle, scenario and gains are in the recorded files
        if root not in SETTABLE or SETTABLE[root].node not in nodes:
            continue
        block = SETTABLE[root]
        try:
            _, value = parse_assignment(text)
            content = replace_parameter(block.model().model_dump(), path, value, root)
            valid = validate_content(block.model, content, 'its provenance')
        except BadInput as error:
            raise BadInput(
                f"The recording sets '{text}', which lta simulate --set refuses ("
                f'{str(error).rstrip(".")}); leave {block.node} out of --nodes.'
            ) from None
        # A node takes no integer for a parameter that is a float, which `--set` may write so
        accepted = get_parameter(valid.model_dump(), path, root)
        settings.setdefault(block.node, {})[block.prefix + path] = (
            accepted if isinstance(accepted, float) else value
        )
    return settings
