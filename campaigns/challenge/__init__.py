# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hide effects in flights of a simulator that shares no equation with the model, and score."""
