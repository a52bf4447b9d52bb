// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The light board on an emulated Cortex-M7 in a simulated world: `make campaign end_to_end`.
 *
 * Converter and link are memory that a program of the host shares, which takes the place of DMA: rows
 * come in at CONVERTER, frames go out at LINK, as to the USB controller of a Teensy. What the bridge
 * sends comes by UART0. A timer of the board is its clock, in the host's real time. */
#include "../core/light_board.h"
#include "mps2.h"
#include <string.h>

#define TIMER_CONTROL REGISTER(0x40002008) /* CMSDK dual timer: counts down, freely */
#define TIMER_VALUE REGISTER(0x40002004)
#define INTERRUPT_ENABLE REGISTER(0xE000E100)
#define CONVERTER 0x60000000u /* PSRAM: rows written so far, then at FIRST the rows in turn */
#define LINK 0x60C00000u      /* bytes written so far, then at FIRST the bytes in turn */

enum { TIMER_ON_32_BITS_BY_16 = 0x86, TICKS_PER_16_US = 25, WAKE_US = 1000 };
enum { UART_RX_INTERRUPT = 8 + ENABLE_BOTH, UART_RX_CLEAR = 2, UART_RX_LINE = 1, HEARD_BYTES = 512 };
enum { FIRST = 64, CONVERTER_ROWS = 1 << 19, LINK_BYTES = 1 << 20 };

static light_board_t board;
static volatile uint8_t heard[HEARD_BYTES];
static volatile uint32_t heard_count;

static uint64_t now_us(void)
{
    static uint64_t ticks;
    static uint32_t last = UINT32_MAX;
    const uint32_t value = TIMER_VALUE;
    ticks += last - value;
    last = value;
    return ticks * 16 / TICKS_PER_16_US;
}

static bool send(void *link, const uint8_t *bytes, size_t count)
{
    (void)link;
    const uint32_t written = REGISTER(LINK);
    for (size_t i = 0; i < count; i++)
        ((volatile uint8_t *)(LINK + FIRST))[(written + i) % LINK_BYTES] = bytes[i];
    __atomic_thread_fence(__ATOMIC_RELEASE); /* the bytes before the count that shows them */
    REGISTER(LINK) = written + (uint32_t)count;
    return true;
}

static void receive(void)
{
    UART_INTERRUPT = UART_RX_CLEAR;
    while (UART_STATE & RX_FULL) {
        heard[heard_count % HEARD_BYTES] = (uint8_t)UART_DATA;
        heard_count = heard_count + 1;
    }
}

static void wake(void)
{
}

/* Sample the rows that are due by our clock. The world may be late, and the ring may be full:
 * then they wait in the converter's memory, which a real one would overwrite. */
static void sample_due(uint64_t now)
{
    const uint32_t written = REGISTER(CONVERTER);
    __atomic_thread_fence(__ATOMIC_ACQUIRE); /* the count before the rows that it shows */
    if (written == 0)
        return;
    if (board.config.start_us == 0)
        board.config.start_us = now - (uint64_t)written * PERIOD_US;
    while (board.sampled < written && ring_waiting(&board.ring) < RING_ROWS
           && board.sampled * PERIOD_US < now - board.config.start_us) {
        uint16_t row[DIODES];
        const uint32_t place = (uint32_t)board.sampled % CONVERTER_ROWS;
        memcpy(row, (const void *)(CONVERTER + FIRST + place * sizeof row), sizeof row);
        light_board_sample(&board, row);
    }
}

void reset(void)
{
    begin_hardware();
    UART_CONTROL = UART_RX_INTERRUPT;
    INTERRUPT_ENABLE = UART_RX_LINE;
    TIMER_CONTROL = TIMER_ON_32_BITS_BY_16;
    light_board_begin(&board, (light_board_config_t){.diodes = DIODES, .sample_rate = 1e6f / PERIOD_US, .send = send});
    begin_systick(CLOCK_MHZ * WAKE_US);
    for (uint32_t taken = 0;;) {
        for (; taken != heard_count; taken++) {
            const uint8_t byte = heard[taken % HEARD_BYTES];
            light_board_hear(&board, &byte, 1, now_us());
        }
        sample_due(now_us());
        light_board_work(&board, now_us());
        __asm__ volatile("wfi"); /* until a byte, or the next millisecond */
    }
}

/* The loader fills the memory, .data and zeros included: nothing is to be copied. */
__attribute__((section(".vectors"), used)) static const void *const vectors[17] = {
    [0] = &stack_top, [1] = reset, [2] = fault, [3] = fault, [4] = fault, [5] = fault, [6] = fault,
    [11] = fault, [14] = fault, [15] = wake, [16] = receive,
};
