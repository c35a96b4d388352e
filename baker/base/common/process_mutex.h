// Mutexes of the whole process.
#pragma once

#include <mutex>
#include <new>
#include <pthread.h>

namespace pliant {

// One for each Tag. A child that is forked while a thread holds it does not have that thread: it finds the mutex free.
template <class Tag> std::mutex& process_mutex()
{
    static std::mutex instance;
    [[maybe_unused]] static const int is_set = ::pthread_atfork(nullptr, nullptr, [] { new (&instance) std::mutex; });
    return instance;
}

} // namespace pliant
