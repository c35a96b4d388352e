/* Clock and medians for benchmarks. Include after _POSIX_C_SOURCE is defined as 199309L or later. */
#ifndef PLIANT_BENCH_TIMING_H
#define PLIANT_BENCH_TIMING_H

#include <stdlib.h>
#include <time.h>

/* Microseconds. */
static inline double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static inline int compare_numbers(const void* a, const void* b)
{
    const double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

/* Sorts the values. */
static inline double median(double* values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare_numbers);
    return values[count / 2];
}

#endif
