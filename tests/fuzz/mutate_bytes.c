/* The mutator of bytes where libFuzzer is not. */
#include <stddef.h>
#include <stdint.h>

size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

/* Another byte somewhere. */
size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size)
{
    static uint32_t random = 1;
    random = random * 1664525u + 1013904223u;
    if (size > 0) data[(random >> 8) % size] ^= (uint8_t)(1u + (random >> 24) % 255u);
    return size < max_size ? size : max_size;
}
