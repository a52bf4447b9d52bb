# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Tune controller gains over a range of helium losses and assess their robustness."""
