#include "base/common/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace pliant {

namespace {

std::atomic<unsigned> wanted_threads { 0 };

// Below this, starting a thread (some 20 microseconds) costs more than it saves.
constexpr std::size_t serial_limit = 4000;

// Set inside a task: its threads are taken.
thread_local bool is_inside_task = false;

unsigned thread_count()
{
    return wanted_threads ? wanted_threads.load() : std::max(1u, std::thread::hardware_concurrency());
}

// Up to `count`, numbered from 1, beside the calling thread. A system that is short of threads gives fewer; the results are
// the same.
template <class Work> std::vector<std::thread> start_threads(std::size_t count, const Work& work)
{
    std::vector<std::thread> threads;
    threads.reserve(count);
    try {
        while (threads.size() < count) threads.emplace_back(work, threads.size() + 1);
    } catch (const std::system_error&) {
    } catch (const std::bad_alloc&) {
    }
    return threads;
}

// Relaxed: a counter shares out work and orders nothing else. A stronger order would also hide races of the work from
// ThreadSanitizer.
std::size_t take_next(std::atomic<std::size_t>& next) { return next.fetch_add(1, std::memory_order_relaxed); }

} // namespace

void set_thread_count(unsigned count) { wanted_threads = count; }

void for_each_piece(std::size_t count, const std::function<void(std::size_t, std::size_t, std::size_t)>& work)
{
    std::atomic<std::size_t> next { 0 };
    const auto take_pieces = [&] {
        for (std::size_t piece = take_next(next); piece < piece_count; piece = take_next(next))
            work(piece, count * piece / piece_count, count * (piece + 1) / piece_count);
    };
    const unsigned threads = count < serial_limit || is_inside_task ? 1 : thread_count();
    std::vector<std::thread> others
        = start_threads(std::min<std::size_t>(threads, piece_count) - 1, [&](std::size_t) { take_pieces(); });
    take_pieces();
    for (std::thread& other : others) other.join();
}

std::size_t worker_count() { return std::min<std::size_t>(thread_count(), piece_count); }

void for_each_task(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work)
{
    std::atomic<std::size_t> next { 0 };
    std::mutex mutex; // of the two below
    std::size_t failed_task = count;
    std::exception_ptr failure;
    const std::size_t workers = std::min(worker_count(), count);
    const bool was_inside_task = is_inside_task;
    const auto take_tasks = [&](std::size_t worker) {
        is_inside_task = was_inside_task || workers > 1; // a lone task has all threads to itself
        for (std::size_t task = take_next(next); task < count; task = take_next(next)) {
            try {
                work(task, worker);
            } catch (...) {
                next.store(count, std::memory_order_relaxed);
                const std::lock_guard<std::mutex> lock(mutex);
                if (task < failed_task) failed_task = task, failure = std::current_exception();
            }
        }
        is_inside_task = was_inside_task;
    };
    std::vector<std::thread> others = start_threads(std::max<std::size_t>(workers, 1) - 1, take_tasks);
    take_tasks(0);
    for (std::thread& other : others) other.join();
    if (failure) std::rethrow_exception(failure);
}

} // namespace pliant
