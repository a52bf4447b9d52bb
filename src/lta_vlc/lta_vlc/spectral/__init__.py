# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""The spectrum of a light block: its bins, tones and noise."""
