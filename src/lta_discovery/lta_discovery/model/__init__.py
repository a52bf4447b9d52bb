# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Represent a vehicle by its parameters and compile its effects for the replay."""
