# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
The model once more, slow and obvious: vectors, matrices, cross products and a linear solve.

Written from the equations in the effects' docstrings and their sources, with none of their code:
`air`, `rotors`, `hull`, `lift`, `jets`, `contacts` and `body` hold one function for each effect,
`motion` what they act on. Parameters come as a mapping from names to numbers; those left out are
at their null values.
"""
