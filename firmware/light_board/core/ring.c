// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
#include "ring.h"

uint32_t ring_waiting(const ring_t *ring)
{
    const uint32_t waiting = ring->written - ring->taken;
    __atomic_thread_fence(__ATOMIC_ACQUIRE); /* the count before the rows that it shows */
    return waiting;
}

bool ring_put(ring_t *ring, const row_t *row)
{
    if (ring_waiting(ring) == RING_ROWS)
        return false;
    ring->rows[ring->written % RING_ROWS] = *row;
    __atomic_thread_fence(__ATOMIC_RELEASE); /* the row before the count that shows it */
    ring->written = ring->written + 1;
    return true;
}

const row_t *ring_peek(const ring_t *ring, uint32_t ahead)
{
    return &ring->rows[(ring->taken + ahead) % RING_ROWS];
}

void ring_drop(ring_t *ring, uint32_t rows)
{
    __atomic_thread_fence(__ATOMIC_RELEASE); /* read before it is free */
    ring->taken = ring->taken + rows;
}
