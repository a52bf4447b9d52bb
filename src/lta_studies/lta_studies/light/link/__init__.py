# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Link budget from a lamp to the photodiodes: illuminance and SNR by distance."""
