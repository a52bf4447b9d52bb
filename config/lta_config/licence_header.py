"""The header of our files as ament_copyright reads it; an entry point of this package tells it."""

from collections import namedtuple

# The fields that it reads; {copyright} is what it found by itself
APACHE_2 = namedtuple('Licence', 'name spdx file_headers license_files contributing_files')(
    'Apache License, Version 2.0',
    'Apache-2.0',
    ['{copyright}\nSPDX-License-Identifier: Apache-2.0'],
    [],
    ['Contributions are under the Apache License 2.0.'],
)
