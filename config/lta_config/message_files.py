# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Find the definitions of messages that no library has, and the units in the comments of ours."""

from collections.abc import Mapping
from functools import cache
import os
from pathlib import Path
import re
from typing import Final

from lta_config.files import share_folder

MESSAGE_PACKAGE: Final = 'lta_msgs'
FIELD_UNIT: Final = re.compile(r'^\w[\w/]*(?:\[\])? +(\w+) *# \[([^]]+)\]', re.MULTILINE)


@cache
def list_message_files() -> Mapping[str, Path]:
    """Return the definitions by type name, as 'lta_msgs/msg/ActuatorDuty'."""
    share = share_folder()
    prefixes = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    # The source tree has them in src/, a wheel beside the share of lta_config, ROS in its prefixes
    for folder in (
        share.parent / 'src' / MESSAGE_PACKAGE / 'msg',
        share.parent / MESSAGE_PACKAGE / 'msg',
        *(Path(prefix, 'share', MESSAGE_PACKAGE, 'msg') for prefix in prefixes if prefix),
    ):
        if paths := sorted(folder.glob('*.msg')):
            return {f'{MESSAGE_PACKAGE}/msg/{path.stem}': path for path in paths}
    return {}


def find_message_file(type_name: str) -> Path | None:
    """Return the definition of a message of a package in AMENT_PREFIX_PATH; None without one."""
    if not re.fullmatch(r'[A-Za-z]\w*/msg/[A-Za-z]\w*', type_name):
        return None
    place = Path('share', f'{type_name}.msg')
    prefixes = os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    paths = (Path(prefix) / place for prefix in prefixes if prefix)
    return next((path for path in paths if path.is_file()), None)


@cache
def read_field_units() -> Mapping[str, Mapping[str, str]]:
    """Return the unit of each number by type name and field, from the comments."""
    return {
        name: dict(FIELD_UNIT.findall(path.read_text('utf-8')))
        for name, path in list_message_files().items()
    }
