"""Install lta_challenge as an ament_python package."""

from setuptools import find_packages, setup

setup(
    name='lta_challenge',
    version='1.0.0',
    packages=find_packages(),
    package_data={'lta_challenge': ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/lta_challenge']),
        ('share/lta_challenge', ['package.xml']),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},  # `colcon test` looks for it
    zip_safe=False,
    maintainer='LTA maintainers',
    maintainer_email='maintainers@users.noreply.github.com',
    description='Generate flights with hidden effects and score discovery on them.',
    license='Apache-2.0',
    entry_points={'console_scripts': []},
)
