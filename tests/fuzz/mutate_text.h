// Mutating texts by their words and lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

// As LLVMFuzzerCustomMutator, of which it is most.
std::size_t mutate_text(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned int seed);
