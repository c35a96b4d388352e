// The mutator of targets whose input is a text, or bytes without a structure that we know.
#include "mutate_text.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned int seed)
{
    return mutate_text(data, size, max_size, seed);
}
