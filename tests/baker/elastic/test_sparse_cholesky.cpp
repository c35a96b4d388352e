// Children that are forked while other threads factor.
#include "elastic/average/sparse_cholesky.h"

#include <atomic>
#include <chrono>
#include <doctest/doctest.h>
#include <pthread.h>
#include <thread>
#include <vector>

#ifdef __linux__
#include <ctime>
#include <sys/wait.h>
#include <unistd.h>

using namespace pliant;
using namespace std::chrono_literals;

namespace {

// Of a grid of side^3 points: the lower triangle.
SparseLower laplacian(Eigen::Index side)
{
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    const Eigen::Index strides[] = { 1, side, side * side };
    for (Eigen::Index i = 0; i < side * side * side; ++i) {
        entries.emplace_back(i, i, 7.0);
        for (Eigen::Index stride : strides)
            if ((i / stride) % side + 1 < side) entries.emplace_back(i + stride, i, -1.0);
    }
    SparseLower matrix(side * side * side, side * side * side);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

class FactoringThread {
public:
    explicit FactoringThread(const SparseLower& matrix)
        : thread_([this, &matrix] {
            while (!is_over_) {
                SparseCholesky solver(SolverKind::cholmod);
                is_well_ = solver.factorize(matrix) && is_well_;
            }
        })
    {
        ::pthread_getcpuclockid(thread_.native_handle(), &clock_);
    }

    bool end() // whether all factorisations succeeded
    {
        is_over_ = true;
        thread_.join();
        return is_well_;
    }

    double seconds() const // of processor time
    {
        timespec time {};
        ::clock_gettime(clock_, &time);
        return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
    }

private:
    std::atomic<bool> is_over_ = false, is_well_ = true;
    std::thread thread_;
    clockid_t clock_ {};
};

const FactoringThread* watched = nullptr;
double seconds_while_forking = -1;

void watch()
{
    if (!watched) return;
    const double start = watched->seconds();
    std::this_thread::sleep_for(100ms);
    seconds_while_forking = watched->seconds() - start;
}

} // namespace

TEST_CASE("while a process forks no thread is in CHOLMOD, whose locks a child would never find free")
{
    if (!has_cholmod()) return;
    // The last handler that was set runs first: this one is set before that of the solver.
    REQUIRE(::pthread_atfork(watch, nullptr, nullptr) == 0);
    const SparseLower matrix = laplacian(30);
    FactoringThread thread(matrix);
    watched = &thread;
    while (thread.seconds() < 0.1) std::this_thread::sleep_for(1ms);
    for (int k = 0; k < 5; ++k) {
        const pid_t child = ::fork();
        if (child == 0) {
            ::alarm(60);
            SparseCholesky solver(SolverKind::cholmod);
            ::_exit(solver.factorize(laplacian(8)) ? 0 : 1);
        }
        int status = -1;
        REQUIRE(::waitpid(child, &status, 0) == child);
        CHECK(status == 0);
        CHECK(seconds_while_forking >= 0);
        CHECK(seconds_while_forking < 0.02); // its way to the lock, also on a machine with other work
    }
    watched = nullptr;
    CHECK(thread.end());
}
#endif
