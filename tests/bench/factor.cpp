// What other solvers need to factor the Hessian of a shell: a row of a Markdown table for each solver and mesh.
//   pliant_bench_factor LEVELS POSE...      the poses, and so many subdivisions of them
// The matrix is what Newton's method factors at the mean of the poses: the projected Hessian with six pinned unknowns. Every
// solver runs in a process of its own, with one thread and one right-hand side. The residual tells a failed factorisation.
#include "bake/make_energy.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/average/sparse_cholesky.h"
#include "input/poses/load_poses.h"

#include <iostream> // before Eigen/MetisSupport, which lacks it

#include <Eigen/CholmodSupport>
#include <Eigen/MetisSupport>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <chrono>
#include <fmt/core.h>
#include <malloc.h>
#include <map>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef PLIANT_WITH_MUMPS
#include <dmumps_c.h>
#endif
#ifdef PLIANT_WITH_SUPERLU
#include <slu_ddefs.h>
#endif
extern "C" void openblas_set_num_threads(int) __attribute__((weak));
extern "C" void omp_set_max_active_levels(int) __attribute__((weak));

using namespace pliant;
using Eigen::Lower, Eigen::VectorXd;
using Matrix32 = Eigen::SparseMatrix<double, Eigen::ColMajor, int>; // METIS and SuperLU of Debian take 32-bit indices

namespace {

// Every solver is made from the matrix and has these functions.
template <class Decomposition> struct EigenSolver {
    void analyse() { decomposition.analyzePattern(matrix); }
    void factorize() { decomposition.factorize(matrix); }
    VectorXd solve(const VectorXd& right) { return decomposition.solve(right); }
    typename Decomposition::MatrixType matrix;
    Decomposition decomposition {};
};

struct Cholmod : Eigen::CholmodSupernodalLLT<SparseLower> {
    Cholmod() // as in sparse_cholesky.cpp
    {
        cholmod().nmethods = 1;
        cholmod().method[0].ordering = CHOLMOD_METIS;
    }
};

// The place of every unknown in METIS's nested dissection.
Eigen::VectorXi metis_places(const Matrix32& full)
{
    Eigen::MetisOrdering<int>::PermutationType order;
    Eigen::MetisOrdering<int>()(full, order);
    return order.inverse().eval().indices();
}

#ifdef PLIANT_WITH_MUMPS
// MUMPS of Debian is built without METIS, so the ordering is handed over.
struct Mumps {
    explicit Mumps(const SparseLower& lower)
        : full(Matrix32(lower).selfadjointView<Lower>())
    {
        for (int column = 0; column < lower.cols(); ++column) {
            for (SparseLower::InnerIterator it(lower, column); it; ++it) rows.push_back(int(it.row()) + 1);
            columns.resize(rows.size(), column + 1);
        }
        mumps.sym = mumps.par = 1;    // positive definite
        mumps.comm_fortran = -987654; // all processes: this one
        run(-1);
        std::fill_n(mumps.icntl, 4, 0); // prints nothing
        mumps.icntl[6] = 1;             // takes perm_in
        mumps.n = int(lower.cols());
        mumps.nnz = lower.nonZeros();
        mumps.irn = rows.data();
        mumps.jcn = columns.data();
        mumps.a = const_cast<double*>(lower.valuePtr());
    }
    void run(int job)
    {
        mumps.job = job;
        dmumps_c(&mumps);
    }
    void analyse()
    {
        places = metis_places(full).array() + 1;
        mumps.perm_in = places.data();
        run(1);
    }
    void factorize() { run(2); }
    VectorXd solve(VectorXd right)
    {
        mumps.rhs = right.data();
        run(3);
        return right;
    }
    Matrix32 full;
    std::vector<int> rows, columns;
    Eigen::VectorXi places;
    DMUMPS_STRUC_C mumps {};
};
#endif

#ifdef PLIANT_WITH_SUPERLU
// LU without row exchanges: SuperLU has no Cholesky factorisation.
struct SuperLu {
    explicit SuperLu(const SparseLower& lower)
        : full(Matrix32(lower).selfadjointView<Lower>())
    {
        set_default_options(&options);
        options.SymmetricMode = YES;
        options.DiagPivotThresh = 0;
        dCreate_CompCol_Matrix(&a, int(full.rows()), int(full.cols()), int(full.nonZeros()), full.valuePtr(),
                               full.innerIndexPtr(), full.outerIndexPtr(), SLU_NC, SLU_D, SLU_GE);
        StatInit(&statistics);
    }
    void analyse()
    {
        places = row_places = tree = metis_places(full); // the others are overwritten
        if (permuted.Store) Destroy_CompCol_Permuted(&permuted);
        sp_preorder(&options, &a, places.data(), tree.data(), &permuted);
    }
    void factorize()
    {
        if (l.Store) Destroy_SuperNode_Matrix(&l);
        if (u.Store) Destroy_CompCol_Matrix(&u);
        dgstrf(&options, &permuted, sp_ienv(2), sp_ienv(1), tree.data(), nullptr, 0, places.data(), row_places.data(), &l,
               &u, &global, &statistics, &info);
    }
    VectorXd solve(VectorXd right)
    {
        SuperMatrix b {};
        dCreate_Dense_Matrix(&b, a.nrow, 1, right.data(), a.nrow, SLU_DN, SLU_D, SLU_GE);
        dgstrs(NOTRANS, &l, &u, places.data(), row_places.data(), &b, &statistics, &info);
        return right;
    }
    Matrix32 full;
    Eigen::VectorXi places, row_places, tree;
    superlu_options_t options {};
    SuperMatrix a {}, permuted {}, l {}, u {};
    GlobalLU_t global {};
    SuperLUStat_t statistics {};
    int info = 0;
};
#endif

// Prints the median of three.
template <class F> void print_seconds(F f)
{
    double times[3];
    for (double& time : times) {
        const auto start = std::chrono::steady_clock::now();
        f();
        time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    std::sort(times, times + 3);
    fmt::print(" {:.3g} |", times[1]);
}

double peak_mebibytes()
{
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024;
}

// Prints the row of a solver. Memory is what it needs beyond the lower triangle.
template <class Solver> void measure(const char* name, const SparseLower& lower)
{
    fmt::print("| {} | {} |", lower.cols() / 3, name);
    malloc_trim(0);
    if (fork() == 0) {
        alarm(300); // stops it
        const auto matrix = lower.selfadjointView<Lower>();
        const VectorXd right = matrix * VectorXd::LinSpaced(lower.cols(), -1, 2);
        VectorXd x;
        const double before = peak_mebibytes();
        Solver solver { lower };
        print_seconds([&] { solver.analyse(); });
        print_seconds([&] { solver.factorize(); });
        print_seconds([&] { x = solver.solve(right); });
        fmt::print(" {:.0f} | {:.0e} |\n", peak_mebibytes() - before, (matrix * x - right).norm() / right.norm());
        _exit(0);
    }
    int status = 0;
    wait(&status);
    if (status) fmt::print(" {} |\n", WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM ? "stopped" : "failed");
}

void measure_all(const PoseSet& poses)
{
    const NormalizedPoses set = normalize(poses);
    const std::unique_ptr<Energy> energy = make_energy(set, EnergyOptions());
    const Weights w = Weights::Constant(Eigen::Index(set.pose_count()), 1.0 / double(set.pose_count()));
    Shape mean = Shape::Zero(set.dof_count());
    for (const Shape& shape : set.shapes) mean += w[0] * shape;
    HessianAssembler assembler(*energy);
    assembler.assemble(w, mean, HessianKind::projected);
    pin(assembler.matrix(), statically_determinate_pins(mean));
    const SparseLower& lower = assembler.matrix();
    measure<EigenSolver<Cholmod>>("CHOLMOD, METIS", lower);
#ifdef PLIANT_WITH_MUMPS
    measure<Mumps>("MUMPS, METIS", lower);
#endif
#ifdef PLIANT_WITH_SUPERLU
    measure<SuperLu>("SuperLU, METIS", lower);
#endif
    measure<EigenSolver<Eigen::SimplicialLLT<Matrix32, Lower, Eigen::MetisOrdering<int>>>>("Eigen, METIS", lower);
    measure<EigenSolver<Eigen::SimplicialLLT<SparseLower, Lower, Eigen::AMDOrdering<std::int64_t>>>>("Eigen, AMD", lower);
}

// A vertex in the middle of every edge.
PoseSet subdivided(const PoseSet& poses)
{
    const std::uint32_t count = std::uint32_t(poses.vertex_count());
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    PoseSet out;
    for (const Triangle& t : poses.triangles) {
        Triangle m;
        for (std::size_t i = 0; i < 3; ++i)
            m[i] = middles.emplace(std::minmax({ t[i], t[(i + 1) % 3] }), count + middles.size()).first->second;
        out.triangles.insert(out.triangles.end(), { { t[0], m[0], m[2] }, { t[1], m[1], m[0] }, { t[2], m[2], m[1] }, m });
    }
    for (const Positions& coarse : poses.positions) {
        Positions& fine = out.positions.emplace_back(count + middles.size(), 3);
        fine.topRows(count) = coarse;
        for (const auto& [ends, v] : middles) fine.row(v) = 0.5 * (coarse.row(ends.first) + coarse.row(ends.second));
    }
    return out;
}

} // namespace

int main(int argc, char** argv)
{
    if (argc < 3) return 2;
    if (openblas_set_num_threads) openblas_set_num_threads(1);
    if (omp_set_max_active_levels) omp_set_max_active_levels(0);
    std::setbuf(stdout, nullptr);
    fmt::print("{}\n\n| vertices | solver | analysis s | factorisation s | solve s | MiB | residual |\n", blas_in_use());
    fmt::print("|---|---|---|---|---|---|---|\n");
    PoseSet poses = load_poses(std::vector<std::string>(argv + 2, argv + argc));
    for (int level = 0; level <= std::stoi(argv[1]); ++level, poses = subdivided(poses)) measure_all(poses);
    return 0;
}
