#include "energy/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace pliant {

namespace {

std::atomic<unsigned> wanted_threads { 0 };

// Below this, starting a thread (some 20 microseconds) costs more than it saves.
constexpr std::size_t serial_limit = 4000;

} // namespace

void set_thread_count(unsigned count) { wanted_threads = count; }

void for_each_piece(std::size_t count, const std::function<void(std::size_t, std::size_t, std::size_t)>& work)
{
    std::atomic<std::size_t> next { 0 };
    const auto take_pieces = [&] {
        for (std::size_t piece = next++; piece < piece_count; piece = next++)
            work(piece, count * piece / piece_count, count * (piece + 1) / piece_count);
    };
    unsigned threads = wanted_threads ? wanted_threads.load() : std::max(1u, std::thread::hardware_concurrency());
    if (count < serial_limit) threads = 1;
    std::vector<std::thread> others;
    for (unsigned i = 1; i < std::min<unsigned>(threads, piece_count); ++i) others.emplace_back(take_pieces);
    take_pieces();
    for (std::thread& other : others) other.join();
}

} // namespace pliant
