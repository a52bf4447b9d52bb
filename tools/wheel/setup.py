# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
All of LTA that needs no ROS graph as one wheel: the cores, the `lta` command, the shipped files.

Called by tools/wheel.sh. The workspace's own packages stay as colcon wants them; this puts their
Python side by side, and the facts of config/ where `lta_config.files.share_folder` looks for them.
"""

import os
from pathlib import Path
import runpy
import sysconfig

from setuptools import find_packages, setup

ROOT = Path(os.environ['LTA_ROOT'])
# What building a workspace needs, and no wheel
OF_WORKSPACE = ('ros-', 'colcon-', 'pymavlink', 'setuptools')
# The message classes, for bags; there are wheels for this platform only
MESSAGES = "ros-jazzy-common-interfaces; sys_platform == 'linux' and platform_machine == 'x86_64'"
# As in 'lta-...whl[notebook,video]'
EXTRAS = ('notebook', 'hardware', 'dask', 'video')
NOT_INSTALLED = ('package.xml', 'resource')


def read_requirements(name: str) -> list[str]:
    """Return the lines of a requirements file that a wheel needs."""
    lines = (ROOT / name).read_text(encoding='utf-8').splitlines()
    return [line for line in lines if line and not line.startswith(('#', *OF_WORKSPACE))]


sources = {'lta_config': ROOT / 'config'}
sources |= {path.parent.name: path.parent for path in sorted(ROOT.glob('src/*/setup.py'))}
packages = [
    package
    for name, folder in sources.items()
    for package in find_packages(str(folder))
    if package.split('.')[0] == name
]
# The classes of the messages that "make build" generates
generated = Path(sysconfig.get_path('purelib'))
packages += ['lta_msgs', 'lta_msgs.msg', 'lta_msgs.action', 'tf2_msgs', 'tf2_msgs.msg']
sources |= {'lta_msgs': generated, 'tf2_msgs': generated}
facts = [
    path.relative_to(ROOT / 'config')
    for path in sorted((ROOT / 'config').rglob('*'))
    if (path.suffix in ('.yaml', '.json', '.xml') and path.name not in NOT_INSTALLED)
    or path.parent.name == 'openfoam'
]
folders = sorted({path.parent for path in facts})

setup(
    name='lta',
    version=runpy.run_path(str(ROOT / 'config/lta_config/version.py'))['VERSION'],
    description='Simulate, record and understand lighter-than-air micro-drones.',
    license='Apache-2.0',
    license_files=['LICENSE'],
    python_requires='>=3.11,<3.15',
    packages=packages,
    package_dir={name: os.path.relpath(folder / name) for name, folder in sources.items()},
    package_data={name: ['py.typed', 'assets/*', 'selection/*.yaml'] for name in sources},
    data_files=[
        (
            f'share/lta_config/{folder}',
            [os.path.relpath(ROOT / 'config' / path) for path in facts if path.parent == folder],
        )
        for folder in folders
    ]
    + [('share/lta_config', ['commit'])]
    # To record and read them without ROS
    + [
        (
            'share/lta_msgs/msg',
            [os.path.relpath(path) for path in sorted(ROOT.glob('src/lta_msgs/msg/*.msg'))],
        )
    ],
    install_requires=[*read_requirements('requirements.txt'), MESSAGES],
    extras_require={name: read_requirements(f'requirements-{name}.txt') for name in EXTRAS},
    entry_points={'console_scripts': ['lta = lta_cli.command:main']},
    zip_safe=False,
)
