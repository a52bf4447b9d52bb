"""
All of LTA that needs no ROS as one wheel: the cores, the `lta` command, the shipped files.

Called by tools/wheel.sh. The workspace's own packages stay as colcon wants them; this puts their
Python side by side, and the facts of config/ where `lta_config.files.share_folder` looks for them.
"""

import os
from pathlib import Path
import runpy

from setuptools import find_packages, setup

ROOT = Path(os.environ['LTA_ROOT'])
OF_ROS = ('ros-', 'colcon-', 'setuptools')  # what a workspace needs, and no wheel
NOT_INSTALLED = ('package.xml', 'resource')

sources = {'lta_config': ROOT / 'config'}
sources |= {path.parent.name: path.parent for path in sorted(ROOT.glob('src/*/package.xml'))}
facts = [
    path.relative_to(ROOT / 'config')
    for path in sorted((ROOT / 'config').rglob('*'))
    if path.suffix in ('.yaml', '.json', '.xml') and path.name not in NOT_INSTALLED
]
folders = sorted({path.parent for path in facts})

setup(
    name='lta-cores',
    version=runpy.run_path(str(ROOT / 'config/lta_config/version.py'))['VERSION'],
    description='Simulate, record and understand lighter-than-air micro-drones, without ROS.',
    license='Apache-2.0',
    license_files=['LICENSE'],
    python_requires='>=3.11,<3.15',
    packages=[
        package
        for name, folder in sources.items()
        for package in find_packages(str(folder))
        if package.split('.')[0] == name
    ],
    package_dir={name: os.path.relpath(folder / name) for name, folder in sources.items()},
    package_data={name: ['py.typed', 'assets/*', 'selection/*.yaml'] for name in sources},
    data_files=[
        (
            f'share/lta_config/{folder}',
            [os.path.relpath(ROOT / 'config' / path) for path in facts if path.parent == folder],
        )
        for folder in folders
    ],
    install_requires=[
        line
        for line in (ROOT / 'requirements.txt').read_text(encoding='utf-8').splitlines()
        if line and not line.startswith(('#', *OF_ROS))
    ],
    entry_points={'console_scripts': ['lta = lta_cli.command:main']},
    zip_safe=False,
)
