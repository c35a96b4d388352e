#include "elastic/average/sparse_cholesky.h"

#include "base/common/diagnostics.h"
#include "base/common/memory.h"
#include "base/common/parallel.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fmt/core.h>
#include <mutex>
#include <new>
#include <pthread.h>
#include <shared_mutex>
#include <sstream>
#include <vector>

#ifdef PLIANT_WITH_CHOLMOD
#include <suitesparse/cholmod.h>
#pragma weak cholmod_l_metis // CHOLMOD may have been built without
#if CHOLMOD_MAIN_VERSION < 4
#pragma weak SuiteSparse_config // of a library below CHOLMOD
#endif
// Present when the BLAS behind CHOLMOD is OpenBLAS; its thread count changes the last bits of a factorisation.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
extern "C" int openblas_get_parallel() __attribute__((weak)); // 0: built without threads
extern "C" char* openblas_get_config() __attribute__((weak));
extern "C" char* openblas_get_corename() __attribute__((weak));
extern "C" void* blas_memory_alloc(int) __attribute__((weak));
extern "C" void blas_memory_free(void*) __attribute__((weak));
// Present when CHOLMOD was built with OpenMP: it asks for four threads by itself, which then spin against each other.
extern "C" void omp_set_max_active_levels(int) __attribute__((weak));
#endif

namespace pliant {

namespace {

[[noreturn]] void throw_out_of_memory(Eigen::Index unknowns)
{
    throw Failure(ExitCode::failed,
                  error_at(4301, "", "memory ran out while factoring a system of " + std::to_string(unknowns) + " unknowns",
                           "bake a coarser mesh or use a machine with more memory (about 6 KiB per unknown with CHOLMOD)"));
}

} // namespace

bool has_cholmod()
{
#ifdef PLIANT_WITH_CHOLMOD
    return true;
#else
    return false;
#endif
}

std::string version_of(SolverKind kind)
{
#ifdef PLIANT_WITH_CHOLMOD
    if (kind == SolverKind::cholmod)
        return fmt::format("CHOLMOD {}.{}.{}", CHOLMOD_MAIN_VERSION, CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION);
#endif
    (void)kind;
    return fmt::format("Eigen {}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
}

std::string blas_in_use()
{
#ifdef PLIANT_WITH_CHOLMOD
    if (!openblas_get_config || !openblas_get_corename) return {};
    std::istringstream config(openblas_get_config()); // "OpenBLAS 0.3.21 NO_LAPACKE ..."
    std::string name, number;
    config >> name >> number;
    return name + " " + number + ", " + openblas_get_corename();
#else
    return {};
#endif
}

SolverKind default_solver() { return has_cholmod() ? SolverKind::cholmod : SolverKind::eigen; }

#ifdef PLIANT_WITH_CHOLMOD
namespace {

// A child gets the locks of its parent as they are, those inside OpenBLAS too, but not the threads that hold them. So a fork
// waits until no thread is in CHOLMOD or BLAS, and none enters meanwhile.
struct ForkGate {
    std::mutex entry;
    std::shared_mutex threads;
};

ForkGate& fork_gate()
{
    static ForkGate& gate = *new ForkGate;
    return gate;
}

class Inside {
public:
    Inside()
    {
        [[maybe_unused]] static const int is_set = ::pthread_atfork(close_gate, open_gate, renew_gate);
        is_here_ = true;
        const std::lock_guard<std::mutex> not_while_forking(fork_gate().entry);
        fork_gate().threads.lock_shared();
    }

    ~Inside()
    {
        fork_gate().threads.unlock_shared();
        is_here_ = false;
    }

    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

private:
    static void close_gate()
    {
        if (is_here_) return;
        fork_gate().entry.lock();
        fork_gate().threads.lock();
    }

    static void open_gate()
    {
        if (is_here_) return;
        fork_gate().threads.unlock();
        fork_gate().entry.unlock();
    }

    static void renew_gate() // a child may not unlock what a thread of its parent has locked
    {
        if (!is_here_) new (&fork_gate()) ForkGate;
    }

    // A handler of signals or allocations may fork in here: it does not wait for its own thread.
    static thread_local bool is_here_;
};

thread_local bool Inside::is_here_ = false;

// OpenBLAS built without threads is not safe to call from several: factors come out wrong without a word. Of another BLAS we
// do not know. Then one factorisation is made at a time.
class BlasLock {
public:
    BlasLock()
    {
        static std::mutex one_at_a_time;
        if (!openblas_get_parallel || openblas_get_parallel() == 0) lock_ = std::unique_lock(one_at_a_time);
    }

private:
    Inside inside_; // first: whoever waits for the lock is inside
    std::unique_lock<std::mutex> lock_;
};

constexpr std::size_t blas_buffer_size = std::size_t(128) << 20; // of OpenBLAS, a thread that computes: address space

// OpenBLAS tries for ever to map a buffer where memory is limited and used up. So it maps one for each thread now, after we
// have seen that there is room; it keeps them.
void map_blas_buffers(std::size_t thread_count)
{
    if (!blas_memory_alloc || !is_memory_limited()) return;
    static std::size_t mapped_count = 0;
    std::vector<void*> buffers;
    bool is_enough = true;
    while (buffers.size() < thread_count && is_enough) {
        is_enough = buffers.size() < mapped_count || has_room(blas_buffer_size + blas_buffer_size / 16);
        if (is_enough) buffers.push_back(blas_memory_alloc(0));
    }
    mapped_count = std::max(mapped_count, buffers.size());
    for (void* buffer : buffers) blas_memory_free(buffer);
    if (!is_enough)
        throw Failure(
            ExitCode::failed,
            error_at(4306, "",
                     fmt::format("memory is limited (ulimit -v or -d): OpenBLAS needs {} MiB for each of {} threads",
                                 blas_buffer_size >> 20, thread_count),
                     "raise the limit, or use fewer --threads or --solver eigen"));
}

#if CHOLMOD_MAIN_VERSION < 4
// CHOLMOD does not ask whether METIS ran out of memory: it would take what lies in the array for the ordering. Zeros are
// none, which it sees.
thread_local bool is_analysing = false;

void* allocate(std::size_t size) { return is_analysing ? std::calloc(1, size) : std::malloc(size); }

class Analysis {
public:
    Analysis() { is_analysing = true; }
    ~Analysis() { is_analysing = false; }
};

void install_allocator()
{
    if (&SuiteSparse_config != nullptr) SuiteSparse_config.malloc_func = allocate;
}
#else
struct Analysis {
    ~Analysis() {}
};

void install_allocator() {}
#endif

} // namespace
#endif

struct SparseCholesky::Backend {
    SolverKind kind;
    bool is_analysed = false;
    Eigen::SimplicialLLT<SparseLower, Eigen::Lower, Eigen::AMDOrdering<std::int64_t>> eigen;
#ifdef PLIANT_WITH_CHOLMOD
    cholmod_common common {};
    cholmod_factor* factor = nullptr;

    // A view: CHOLMOD reads the matrix where it lies.
    static cholmod_sparse view(const SparseLower& lower)
    {
        cholmod_sparse a {};
        a.nrow = a.ncol = std::size_t(lower.cols());
        a.nzmax = std::size_t(lower.nonZeros());
        a.p = const_cast<std::int64_t*>(lower.outerIndexPtr());
        a.i = const_cast<std::int64_t*>(lower.innerIndexPtr());
        a.x = const_cast<double*>(lower.valuePtr());
        a.stype = -1;
        a.itype = CHOLMOD_LONG;
        a.xtype = CHOLMOD_REAL;
        a.dtype = CHOLMOD_DOUBLE;
        a.sorted = a.packed = 1;
        return a;
    }

    void start()
    {
        // Once, before any factorisation: it may not be called while another thread is inside.
        static std::mutex one_at_a_time;
        static bool has_started = false;
        {
            const Inside inside;
            const std::lock_guard<std::mutex> lock(one_at_a_time);
            if (!has_started) {
                install_allocator();
                if (openblas_set_num_threads) openblas_set_num_threads(1);
                map_blas_buffers(worker_count());
                has_started = true;
            }
        }
        cholmod_l_start(&common);
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_METIS;
        common.quick_return_if_not_posdef = 1;
        common.print = 0;
    }

    // OpenMP keeps this per thread. Whole factorisations on threads (for_each_task) scale better than one on several.
    static void use_one_thread()
    {
        if (omp_set_max_active_levels) omp_set_max_active_levels(0);
    }

    bool has_metis()
    {
        if (!cholmod_l_metis) return false;
        cholmod_l_metis(nullptr, nullptr, 0, 0, nullptr, &common); // an error in any case
        return common.status != CHOLMOD_NOT_INSTALLED;
    }

    // CHOLMOD takes another ordering if METIS runs out of memory: the asset would have other bits.
    void analyze(cholmod_sparse& a)
    {
        // METIS draws from one generator of the process: two analyses at a time would order by chance.
        static std::mutex one_at_a_time;
        const std::lock_guard<std::mutex> lock(one_at_a_time);
        const Analysis analysis;
        factor = cholmod_l_analyze(&a, &common);
        if (!factor || (factor->ordering != CHOLMOD_METIS && has_metis())) throw_out_of_memory(Eigen::Index(a.ncol));
    }

    bool factorize_cholmod(const SparseLower& lower)
    {
        use_one_thread();
        const BlasLock lock;
        cholmod_sparse a = view(lower);
        if (!factor) analyze(a);
        cholmod_l_factorize(&a, factor, &common);
        if (common.status == CHOLMOD_NOT_POSDEF) return false;
        if (common.status < CHOLMOD_OK) throw_out_of_memory(lower.cols());
        return true;
    }

    Eigen::MatrixXd solve_cholmod(const Eigen::MatrixXd& right)
    {
        use_one_thread();
        const BlasLock lock;
        cholmod_dense b {};
        b.nrow = b.d = std::size_t(right.rows());
        b.ncol = std::size_t(right.cols());
        b.nzmax = b.nrow * b.ncol;
        b.x = const_cast<double*>(right.data());
        b.xtype = CHOLMOD_REAL;
        b.dtype = CHOLMOD_DOUBLE;
        cholmod_dense* x = nullptr;
        // CHOLMOD before 4 overlooks that there is no memory for the first of its two working arrays.
        cholmod_dense* work[2] = { nullptr, nullptr };
        const bool is_solved = cholmod_l_ensure_dense(&work[0], b.nrow, b.ncol, b.nrow, CHOLMOD_REAL, &common)
            && cholmod_l_solve2(CHOLMOD_A, factor, &b, nullptr, &x, nullptr, &work[0], &work[1], &common);
        for (cholmod_dense*& array : work) cholmod_l_free_dense(&array, &common);
        if (!is_solved) {
            cholmod_l_free_dense(&x, &common);
            throw_out_of_memory(right.rows());
        }
        Eigen::MatrixXd out = Eigen::Map<Eigen::MatrixXd>(static_cast<double*>(x->x), right.rows(), right.cols());
        cholmod_l_free_dense(&x, &common);
        return out;
    }

    void finish()
    {
        if (factor) cholmod_l_free_factor(&factor, &common);
        cholmod_l_finish(&common);
    }
#endif
};

SparseCholesky::SparseCholesky(SolverKind kind)
    : backend_(std::make_unique<Backend>())
{
    backend_->kind = has_cholmod() ? kind : SolverKind::eigen;
#ifdef PLIANT_WITH_CHOLMOD
    if (backend_->kind == SolverKind::cholmod) backend_->start();
#endif
}

SparseCholesky::~SparseCholesky()
{
#ifdef PLIANT_WITH_CHOLMOD
    if (backend_->kind == SolverKind::cholmod) backend_->finish();
#endif
}

bool SparseCholesky::factorize(const SparseLower& lower)
{
    ++count_;
#ifdef PLIANT_WITH_CHOLMOD
    if (backend_->kind == SolverKind::cholmod) return backend_->factorize_cholmod(lower);
#endif
    try {
        if (!backend_->is_analysed) backend_->eigen.analyzePattern(lower);
        backend_->is_analysed = true;
        backend_->eigen.factorize(lower);
    } catch (const std::bad_alloc&) {
        throw_out_of_memory(lower.cols());
    }
    return backend_->eigen.info() == Eigen::Success;
}

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& right) const
{
#ifdef PLIANT_WITH_CHOLMOD
    if (backend_->kind == SolverKind::cholmod) return backend_->solve_cholmod(right);
#endif
    return backend_->eigen.solve(right);
}

} // namespace pliant
