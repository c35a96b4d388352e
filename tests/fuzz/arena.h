/* Memory of an exact size without an allocator: a static area, of which all other bytes are poisoned for AddressSanitizer.
   MemorySanitizer takes what is reserved for unwritten. Without them an area is only memory. */
#ifndef PLIANT_FUZZ_ARENA_H
#define PLIANT_FUZZ_ARENA_H

#include <stddef.h>
#include <stdlib.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PLIANT_FUZZ_POISON
#endif
#if __has_feature(memory_sanitizer)
#define PLIANT_FUZZ_UNWRITTEN
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define PLIANT_FUZZ_POISON
#endif
#ifdef PLIANT_FUZZ_POISON
void __asan_poison_memory_region(const volatile void* address, size_t size);
void __asan_unpoison_memory_region(const volatile void* address, size_t size);
#else
#define __asan_poison_memory_region(address, size) ((void)0)
#define __asan_unpoison_memory_region(address, size) ((void)0)
#endif
#ifdef PLIANT_FUZZ_UNWRITTEN
void __msan_poison(const volatile void* address, size_t size);
void __msan_check_mem_is_initialized(const volatile void* address, size_t size);
#else
#define __msan_poison(address, size) ((void)0)
#define __msan_check_mem_is_initialized(address, size) ((void)0)
#endif

/* Of `capacity` bytes at `bytes`, a multiple of 64. `end`: behind what is not poisoned. Starts as { bytes, capacity, 0 }. */
typedef struct fuzz_area {
    unsigned char* bytes;
    size_t capacity, end;
} fuzz_area;

/* `size` bytes at a multiple of 64; what was reserved in the area before is gone. At most capacity - 128. */
static inline void* fuzz_reserve(fuzz_area* area, size_t size)
{
    const size_t end = 64 + size;
    if (size > area->capacity - 128) abort();
    if (area->end == 0) __asan_poison_memory_region(area->bytes, area->capacity);
    if (area->end > end) __asan_poison_memory_region(area->bytes + end, area->end - end);
    __asan_unpoison_memory_region(area->bytes + 64, size);
    __msan_poison(area->bytes + 64, size);
    area->end = end;
    return area->bytes + 64;
}

#endif
