# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Install lta_graph as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_graph',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_graph': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_graph']),
        ('share/lta_graph', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Connection, lockstep synchronisation, monitoring and launching of the LTA nodes.',
    license='Apache-2.0',
    entry_points={
        'console_scripts': ['one_process = lta_graph.ros.one_process:main'],
    },
)
