# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Check the quality of a recording; findings name channel, interval and evidence."""
