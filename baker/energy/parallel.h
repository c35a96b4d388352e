// Loops over elements on several threads, with results that do not depend on how many there are.
#pragma once

#include <cstddef>
#include <functional>

namespace pliant {

// Threads that element loops may use, from 1; 0 means as many as the machine has (the default). For the whole process; set it before
// work starts.
void set_thread_count(unsigned count);

// Loops are always cut into this many pieces and sums are made piece by piece in their order, whatever the number of threads.
constexpr std::size_t piece_count = 8;

// Calls work(piece, begin, end) for pieces 0 .. piece_count-1 of the range 0 .. count-1. Pieces may run at the same time: they must
// write to places of their own, and must not throw. Short ranges run on the calling thread.
void for_each_piece(std::size_t count,
                    const std::function<void(std::size_t piece, std::size_t begin, std::size_t end)>& work);

} // namespace pliant
