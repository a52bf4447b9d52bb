# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_control as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_control',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_control': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_control']),
        ('share/lta_control', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='State estimation, cascaded control, rotor allocation and navigation.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'estimator = lta_control.nodes.estimator:main',
            'controller = lta_control.nodes.controller:main',
            'navigator = lta_control.nodes.navigator:main',
        ]
    },
)
