// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* Rows of samples between the interrupt that takes them and the loop that sends them: one writer, one reader, no lock. */
#pragma once
#include <stdbool.h>
#include <stdint.h>

#define RING_DIODES 16
#define RING_ROWS 1024 /* a power of two: 0.1 s at 10 kS/s, for which a busy host may take nothing */

typedef struct {
    uint64_t number; /* rows sampled before this one, lost ones with them */
    uint16_t values[RING_DIODES];
} row_t;

typedef struct {
    row_t rows[RING_ROWS];
    volatile uint32_t written, taken;
} ring_t;

uint32_t ring_waiting(const ring_t *ring);
bool ring_put(ring_t *ring, const row_t *row); /* false where there is no room */
const row_t *ring_peek(const ring_t *ring, uint32_t ahead);
void ring_drop(ring_t *ring, uint32_t rows);
