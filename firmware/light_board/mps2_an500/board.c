// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The light board on Arm's MPS2 board with a Cortex-M7 (AN500), which QEMU emulates: for tests.
 *
 * SysTick takes the samples, UART0 is the link. There are no diodes: raw rows are a pattern by their
 * number; with PEAK_HZ a lamp of that frequency shines, on each diode 100 counts brighter. */
#include "../core/lamp.h"
#include "../core/light_board.h"
#include "mps2.h"

enum { PERIOD = CLOCK_MHZ * PERIOD_US };

static light_board_t board;
static lamp_t lamp;
static volatile uint32_t ticks;

/* Two diodes tell the row's number, the others a pattern: what is lost, doubled or swapped shows. */
static uint16_t pattern(uint32_t row, unsigned diode)
{
    const uint32_t told[] = {row, row >> 12};
    return (diode < 2 ? told[diode] : (DIODES * row + diode) * 2654435761u >> 20) & 0xFFF;
}

static void sample(void)
{
    uint16_t row[DIODES];
    const bool on = lamp_tick(&lamp);
    for (unsigned i = 0; i < DIODES; i++)
        row[i] = PEAK_HZ ? (uint16_t)(500 + (on ? 100 * i : 0)) : pattern(ticks, i);
    light_board_sample(&board, row);
    ticks = ticks + 1;
}

/* The counter runs down; it may begin again between two looks. */
static uint64_t now_us(void)
{
    uint32_t before, left;
    do {
        before = ticks;
        left = SYSTICK_CURRENT;
    } while (before != ticks);
    return (uint64_t)before * PERIOD_US + (PERIOD - left) / CLOCK_MHZ;
}

/* A frame that has begun must end: the link takes a byte at a time, sooner or later. */
static bool send(void *link, const uint8_t *bytes, size_t count)
{
    (void)link;
    if (UART_STATE & TX_FULL)
        return false;
    for (size_t i = 0; i < count; i++) {
        while (UART_STATE & TX_FULL) {
        }
        UART_DATA = bytes[i];
    }
    return true;
}

void reset(void)
{
    begin_hardware();
    lamp_begin(&lamp, PEAK_HZ, 0.5, 1e6 / PERIOD_US, 0.0);
    light_board_begin(&board, (light_board_config_t){.diodes = DIODES, .sample_rate = 1e6f / PERIOD_US,
                                                     .peak_frequency = PEAK_HZ, .start_us = PERIOD_US,
                                                     .send = send});
    begin_systick(PERIOD);
    for (;;) {
        if (UART_STATE & RX_FULL) {
            const uint8_t byte = (uint8_t)UART_DATA;
            light_board_hear(&board, &byte, 1, now_us());
        }
        light_board_work(&board, now_us());
        __asm__ volatile("wfi"); /* until the next sample */
    }
}

/* The loader fills the memory, .data and zeros included: nothing is to be copied. */
__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    [0] = &stack_top, [1] = reset, [2] = fault, [3] = fault, [4] = fault, [5] = fault, [6] = fault,
    [11] = fault, [14] = fault, [15] = sample,
};
