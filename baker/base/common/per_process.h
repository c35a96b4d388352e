// Objects of the whole process.
#pragma once

#include <new>
#include <pthread.h>

namespace pliant {

// One T for each Tag, made at the first use and never destroyed. A forked child gets a new one: the threads that held or
// waited for the old one are not in it.
template <class T, class Tag = T> T& per_process()
{
    alignas(T) static unsigned char place[sizeof(T)];
    static T& instance = *new (place) T;
    [[maybe_unused]] static const int is_set = ::pthread_atfork(nullptr, nullptr, [] { new (place) T; });
    return instance;
}

} // namespace pliant
