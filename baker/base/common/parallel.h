// Loops over elements, and whole tasks, on several threads, with results that do not depend on how many there are.
#pragma once

#include <cstddef>
#include <functional>

namespace pliant {

// Threads that element loops may use, from 1; 0 means as many as the machine has (the default). For the whole process; set
// it before work starts.
void set_thread_count(unsigned count);

// Loops are always cut into this many pieces and sums are made piece by piece in their order, whatever the number of
// threads.
constexpr std::size_t piece_count = 8;

// Calls work(piece, begin, end) for pieces 0 .. piece_count-1 of the range 0 .. count-1. Pieces may run at the same time:
// they must write to places of their own, and must not throw. Short ranges run on the calling thread.
void for_each_piece(std::size_t count,
                    const std::function<void(std::size_t piece, std::size_t begin, std::size_t end)>& work);

// Workers that for_each_task uses: the thread count, but at least 1.
std::size_t worker_count();

// Calls work(task, worker) for tasks 0 .. count-1, each worker on a thread of its own (worker 0 is the calling one). Tasks
// must not depend on each other. Element loops inside a task run on its thread alone: whole tasks on threads scale better.
// If a task throws, no further one starts, and the exception of the first task that threw is thrown again here.
void for_each_task(std::size_t count, const std::function<void(std::size_t task, std::size_t worker)>& work);

} // namespace pliant
