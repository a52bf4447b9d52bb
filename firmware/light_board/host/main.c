// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* The firmware's portable part as a program of the host: rows from a file, MAVLink on a terminal.
 *
 *   light_board TERMINAL ROWS DIODES RATE DRIFT PEAK    TERMINAL: a serial device; ROWS: u16, little endian
 *
 * Its clock is the host's, faster by the part DRIFT; it ends when all rows are sent. */
#define _GNU_SOURCE
#include "../core/light_board.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static double drift;
static uint64_t boot_ns;

static uint64_t now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    const uint64_t ns = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
    if (boot_ns == 0)
        boot_ns = ns;
    return (uint64_t)((double)(ns - boot_ns) * 1e-3 * (1.0 + drift));
}

static bool send(void *link, const uint8_t *bytes, size_t count)
{
    const int file = *(int *)link;
    for (size_t sent = 0; sent < count;) {
        const ssize_t n = write(file, bytes + sent, count - sent);
        if (n > 0)
            sent += (size_t)n;
        else if (sent == 0 || errno != EAGAIN)
            return false;
        else /* a frame that has begun must end */
            poll(&(struct pollfd){.fd = file, .events = POLLOUT}, 1, 100);
    }
    return true;
}

int main(int count, char **words)
{
    if (count != 7)
        return 2;
    int file = open(words[1], O_RDWR | O_NOCTTY | O_NONBLOCK);
    FILE *rows = fopen(words[2], "rb");
    if (file < 0 || rows == NULL)
        return 1;
    static light_board_t board;
    drift = atof(words[5]);
    light_board_begin(&board, (light_board_config_t){.diodes = (unsigned)atoi(words[3]), .sample_rate = (float)atof(words[4]),
                                                     .peak_frequency = (float)atof(words[6]), .send = send, .link = &file});
    board.config.start_us = now_us();
    uint16_t row[RING_DIODES];
    bool more = true;
    while (more || ring_waiting(&board.ring) >= 15) {
        const uint64_t now = now_us();
        /* A file can wait, which an ADC cannot: rows that are due while the host was busy come once there is room. */
        while (more && ring_waiting(&board.ring) < RING_ROWS
               && (double)board.sampled < (double)(now - board.config.start_us) * 1e-6 * board.config.sample_rate
               && (more = fread(row, sizeof *row, board.config.diodes, rows) == board.config.diodes))
            light_board_sample(&board, row);
        uint8_t bytes[256];
        const ssize_t n = read(file, bytes, sizeof bytes);
        if (n > 0)
            light_board_hear(&board, bytes, (size_t)n, now_us());
        light_board_work(&board, now);
        poll(&(struct pollfd){.fd = file, .events = POLLIN}, 1, 1);
    }
    fprintf(stderr, "%llu rows, %u overruns\n", (unsigned long long)board.sampled, board.overruns);
    return 0;
}
