# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_config as an ament_python package."""

from pathlib import Path

from setuptools import find_packages, setup

FOLDERS = (
    'aero',
    'cell_tables',
    'cells',
    'comparisons',
    'control',
    'crazyflies',
    'floor_plans',
    'imports',
    'light_days',
    'missions',
    'manoeuvres',
    'mounts',
    'paper',
    'scenarios',
    'spectra',
    'spectral_responses',
    'sweeps',
    'tunnels',
    'vehicles',
)

setup(
    name='lta_config',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_config': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_config']),
        ('share/lta_config', ['package.xml', 'topics.yaml']),
        ('share/lta_config/fastdds', sorted(map(str, Path('fastdds').glob('*.xml')))),
        ('share/lta_config/foxglove', ['foxglove/lta.json']),
        ('share/lta_config/openfoam', sorted(map(str, Path('openfoam').glob('*')))),
        ('share/lta_config/plotjuggler', ['plotjuggler/lta.xml']),
        ('share/lta_config/rviz', ['rviz/lta.rviz']),
        ('share/lta_config/aero', sorted(map(str, Path('aero').glob('*.json')))),
        *(
            (f'share/lta_config/{folder}', sorted(map(str, Path(folder).glob('*.yaml'))))
            for folder in FOLDERS
        ),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Every fact in one place: topics, vehicles, scenarios and gains.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [],
        'ament_copyright.license': ['lta = lta_config.licence_header:APACHE_2'],
    },
)
