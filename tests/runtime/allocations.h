/* Counts the calls of the allocator by everything that is linked, from any thread. Linked with --wrap for malloc, calloc,
   realloc and free. */
#ifndef PLIANT_TEST_ALLOCATIONS_H
#define PLIANT_TEST_ALLOCATIONS_H

#include <stddef.h>

void* __real_malloc(size_t size);
void* __real_calloc(size_t count, size_t size);
void* __real_realloc(void* block, size_t size);
void __real_free(void* block);
void* __wrap_malloc(size_t size);
void* __wrap_calloc(size_t count, size_t size);
void* __wrap_realloc(void* block, size_t size);
void __wrap_free(void* block);

static long allocation_count;

static void count_allocation(void) { __atomic_add_fetch(&allocation_count, 1, __ATOMIC_RELAXED); }

void* __wrap_malloc(size_t size)
{
    count_allocation();
    return __real_malloc(size);
}

void* __wrap_calloc(size_t count, size_t size)
{
    count_allocation();
    return __real_calloc(count, size);
}

void* __wrap_realloc(void* block, size_t size)
{
    count_allocation();
    return __real_realloc(block, size);
}

void __wrap_free(void* block)
{
    count_allocation();
    __real_free(block);
}

#endif
