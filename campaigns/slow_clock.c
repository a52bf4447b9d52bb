/* Let time pass more slowly for the processes that preload this: a busy machine then keeps up with
 * programs that fly in real time (`slow_clock.py`).
 *
 * LTA_SLOWER is the factor, LTA_SLOW_SINCE the time from which on the wall clock is slow [ns]. Clocks are
 * divided, waiting times multiplied. Processor time stays as it is. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#define REAL(name) \
    static __typeof__(&name) real; \
    if (!real) \
        real = (__typeof__(real))dlsym(RTLD_NEXT, #name)
#define SECOND 1000000000ll

static int64_t factor = 1, since;

__attribute__((constructor)) static void begin(void)
{
    const char *slower = getenv("LTA_SLOWER"), *from = getenv("LTA_SLOW_SINCE");
    if (slower && from && atoll(slower) > 0) {
        since = atoll(from);
        factor = atoll(slower);
    }
}

static int64_t to_ns(const struct timespec *time)
{
    return time->tv_sec * SECOND + time->tv_nsec;
}

static struct timespec from_ns(int64_t ns)
{
    return (struct timespec){ns / SECOND, ns % SECOND};
}

static bool is_wall(clockid_t clock)
{
    return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE;
}

static bool is_slow(clockid_t clock)
{
    return is_wall(clock) || clock == CLOCK_MONOTONIC || clock == CLOCK_MONOTONIC_RAW
           || clock == CLOCK_MONOTONIC_COARSE || clock == CLOCK_BOOTTIME;
}

static struct timespec slow(clockid_t clock, const struct timespec *time)
{
    const int64_t origin = is_wall(clock) ? since : 0;
    return is_slow(clock) ? from_ns(origin + (to_ns(time) - origin) / factor) : *time;
}

/* The machine's time of a slow one. */
static struct timespec fast(clockid_t clock, const struct timespec *time)
{
    const int64_t origin = is_wall(clock) ? since : 0;
    return is_slow(clock) ? from_ns(origin + (to_ns(time) - origin) * factor) : *time;
}

static struct timespec longer(const struct timespec *time)
{
    return from_ns(to_ns(time) * factor);
}

static int longer_ms(int ms)
{
    return ms > 0 ? (int)(ms * factor) : ms;
}

int clock_gettime(clockid_t clock, struct timespec *time)
{
    REAL(clock_gettime);
    const int status = real(clock, time);
    if (status == 0)
        *time = slow(clock, time);
    return status;
}

int gettimeofday(struct timeval *restrict time, void *restrict zone)
{
    (void)zone;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    *time = (struct timeval){now.tv_sec, now.tv_nsec / 1000};
    return 0;
}

time_t time(time_t *out)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (out)
        *out = now.tv_sec;
    return now.tv_sec;
}

int clock_nanosleep(clockid_t clock, int flags, const struct timespec *wanted, struct timespec *left)
{
    REAL(clock_nanosleep);
    const struct timespec until = flags & TIMER_ABSTIME ? fast(clock, wanted) : longer(wanted);
    const int status = real(clock, flags, &until, left);
    if (left && status && !(flags & TIMER_ABSTIME))
        *left = from_ns(to_ns(left) / factor);
    return status;
}

int nanosleep(const struct timespec *wanted, struct timespec *left)
{
    REAL(nanosleep);
    const struct timespec all = longer(wanted);
    const int status = real(&all, left);
    if (left && status)
        *left = from_ns(to_ns(left) / factor);
    return status;
}

int usleep(useconds_t us)
{
    return nanosleep(&(struct timespec){us / 1000000, us % 1000000 * 1000}, NULL);
}

unsigned sleep(unsigned seconds)
{
    nanosleep(&(struct timespec){seconds, 0}, NULL);
    return 0;
}

int poll(struct pollfd *files, nfds_t count, int timeout)
{
    REAL(poll);
    return real(files, count, longer_ms(timeout));
}

int ppoll(struct pollfd *files, nfds_t count, const struct timespec *timeout, const sigset_t *mask)
{
    REAL(ppoll);
    const struct timespec all = timeout ? longer(timeout) : (struct timespec){0};
    return real(files, count, timeout ? &all : NULL, mask);
}

int select(int count, fd_set *in, fd_set *out, fd_set *except, struct timeval *timeout)
{
    REAL(select);
    if (!timeout)
        return real(count, in, out, except, NULL);
    const int64_t us = (timeout->tv_sec * 1000000ll + timeout->tv_usec) * factor;
    struct timeval all = {us / 1000000, us % 1000000};
    return real(count, in, out, except, &all);
}

int pselect(int count, fd_set *in, fd_set *out, fd_set *except, const struct timespec *timeout, const sigset_t *mask)
{
    REAL(pselect);
    const struct timespec all = timeout ? longer(timeout) : (struct timespec){0};
    return real(count, in, out, except, timeout ? &all : NULL, mask);
}

int epoll_wait(int file, struct epoll_event *events, int count, int timeout)
{
    REAL(epoll_wait);
    return real(file, events, count, longer_ms(timeout));
}

int epoll_pwait(int file, struct epoll_event *events, int count, int timeout, const sigset_t *mask)
{
    REAL(epoll_pwait);
    return real(file, events, count, longer_ms(timeout), mask);
}

int timerfd_settime(int file, int flags, const struct itimerspec *wanted, struct itimerspec *old)
{
    REAL(timerfd_settime);
    /* Boost gives relative times only; an absolute one counts on the monotonic clock here. */
    const struct itimerspec all = {longer(&wanted->it_interval), flags & TFD_TIMER_ABSTIME
                                   ? fast(CLOCK_MONOTONIC, &wanted->it_value) : longer(&wanted->it_value)};
    return real(file, flags, &all, old);
}

int setsockopt(int file, int level, int name, const void *value, socklen_t size)
{
    REAL(setsockopt);
    if (level != SOL_SOCKET || (name != SO_RCVTIMEO && name != SO_SNDTIMEO) || size != sizeof(struct timeval))
        return real(file, level, name, value, size);
    const struct timeval *timeout = value;
    const int64_t us = (timeout->tv_sec * 1000000ll + timeout->tv_usec) * factor;
    const struct timeval all = {us / 1000000, us % 1000000};
    return real(file, level, name, &all, size);
}

/* Whether a condition's own clock is the monotonic one: as glibc keeps it. */
static clockid_t clock_of(const pthread_cond_t *condition)
{
    return condition->__data.__wrefs & 2 ? CLOCK_MONOTONIC : CLOCK_REALTIME;
}

int pthread_cond_timedwait(pthread_cond_t *restrict condition, pthread_mutex_t *restrict mutex,
                           const struct timespec *restrict until)
{
    static __typeof__(&pthread_cond_timedwait) real;
    if (!real) /* dlsym would give the one of before glibc 2.3.2 */
        real = (__typeof__(real))dlvsym(RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2");
    const struct timespec then = fast(clock_of(condition), until);
    return real(condition, mutex, &then);
}

int pthread_cond_clockwait(pthread_cond_t *restrict condition, pthread_mutex_t *restrict mutex, clockid_t clock,
                           const struct timespec *restrict until)
{
    REAL(pthread_cond_clockwait);
    const struct timespec then = fast(clock, until);
    return real(condition, mutex, clock, &then);
}

int pthread_mutex_timedlock(pthread_mutex_t *restrict mutex, const struct timespec *restrict until)
{
    REAL(pthread_mutex_timedlock);
    const struct timespec then = fast(CLOCK_REALTIME, until);
    return real(mutex, &then);
}

int pthread_mutex_clocklock(pthread_mutex_t *restrict mutex, clockid_t clock, const struct timespec *restrict until)
{
    REAL(pthread_mutex_clocklock);
    const struct timespec then = fast(clock, until);
    return real(mutex, clock, &then);
}

int sem_timedwait(sem_t *restrict semaphore, const struct timespec *restrict until)
{
    REAL(sem_timedwait);
    const struct timespec then = fast(CLOCK_REALTIME, until);
    return real(semaphore, &then);
}

int sem_clockwait(sem_t *restrict semaphore, clockid_t clock, const struct timespec *restrict until)
{
    REAL(sem_clockwait);
    const struct timespec then = fast(clock, until);
    return real(semaphore, clock, &then);
}
