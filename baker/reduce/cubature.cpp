#include "reduce/cubature.h"

#include "reduce/nnls.h"

#include <Eigen/Dense>
#include <algorithm>
#include <fmt/core.h>
#include <numeric>

namespace pliant {

namespace {

// Equilibrium decides where the minimum lies, so its rows count for more than forces elsewhere (found by experiment: 3 to 8 times
// smaller shape error than with weight 1; flat between 10 and 100).
constexpr double equilibrium_weight = 30;

// Rows that the fit sees. More raw rows than this are mixed down by a sparse random projection, which keeps least squares over a few
// hundred columns intact (Clarkson, Woodruff 2013).
constexpr Eigen::Index sketch_rows = 2000;

// What one block of rows evaluates at every element: forces (gradient by q), or the Hessian times directions.
struct Probe {
    Weights w;
    Eigen::VectorXd q;
    double scale;               // of the rows
    Eigen::MatrixXd directions; // d x c in whitened coordinates; empty for forces
    Eigen::Index rows() const { return directions.cols() ? directions.size() : q.size(); }
};

std::vector<Probe> make_probes(const TrainingSet& training, std::uint64_t seed)
{
    Random random(seed ^ 0x9e3779b97f4a7c15ull);
    const Eigen::Index d = training.root.rows();
    const double unit = 1 / std::sqrt(training.energy_scale); // forces in units of the root of the energy
    const std::size_t m = std::size_t(training.weights[0].size());
    std::vector<Probe> probes;
    const double share = 1 / std::sqrt(double(training.weights.size()));
    for (std::size_t t = 0; t < training.weights.size(); ++t) {
        const Weights& w = training.weights[t];
        const Eigen::VectorXd& q = training.averages[t];
        probes.push_back({ w, q, equilibrium_weight * unit * share, {} });
        probes.push_back({ corner_weights(m, random.below(m)), q, unit * share, {} });
        // Where the solver passes on its way: off the average by about the energy that the average has.
        Eigen::VectorXd z(d);
        for (Eigen::Index i = 0; i < d; ++i) z[i] = random.normal();
        z *= std::sqrt(training.energy_scale) * random.uniform() / std::max(z.norm(), 1e-30);
        probes.push_back({ w, q + training.root * z, unit * share, {} });
    }
    // All of the Hessian at the mean, random directions of it elsewhere.
    probes.push_back(
        { training.weights[0], training.averages[0], 1 / std::sqrt(double(d)), Eigen::MatrixXd::Identity(d, d) });
    for (std::size_t t = 1; t < std::min<std::size_t>(training.weights.size(), 9); ++t) {
        const Eigen::Index count = std::min<Eigen::Index>(d, 6);
        Eigen::MatrixXd directions(d, count);
        for (Eigen::Index i = 0; i < directions.size(); ++i) directions.data()[i] = random.normal() / std::sqrt(double(d));
        probes.push_back({ training.weights[t], training.averages[t], 0.5 / std::sqrt(double(count)), directions });
    }
    return probes;
}

// Where raw row r goes: itself if there are few rows, else a random one of sketch_rows with a random sign.
struct Sketch {
    std::vector<std::int32_t> target;
    std::vector<float> sign;
    Eigen::Index rows;
};

Sketch make_sketch(Eigen::Index raw_rows, std::uint64_t seed)
{
    Sketch sketch;
    sketch.rows = std::min(raw_rows, sketch_rows);
    Random random(seed ^ 0x5851f42d4c957f2dull);
    for (Eigen::Index r = 0; r < raw_rows; ++r) {
        const bool is_direct = raw_rows <= sketch_rows;
        sketch.target.push_back(std::int32_t(is_direct ? r : Eigen::Index(random.below(std::size_t(sketch_rows)))));
        sketch.sign.push_back(is_direct || random.uniform() < 0.5 ? 1.f : -1.f);
    }
    return sketch;
}

// Column of one element: its rows of all probes, whitened, sketched. x = base + rows q, and rows S are computed once.
void fill_column(const Energy& energy, std::size_t element, const Eigen::VectorXd& base, const Eigen::MatrixXd& rows,
                 const Eigen::MatrixXd& whitened_rows, const std::vector<Probe>& probes, const Sketch& sketch,
                 Eigen::Ref<Eigen::VectorXd> column)
{
    ElementResult result;
    column.setZero();
    Eigen::Index raw = 0;
    const auto put = [&](const Eigen::MatrixXd& block, double scale) {
        for (Eigen::Index i = 0; i < block.size(); ++i, ++raw)
            column[sketch.target[std::size_t(raw)]] += scale * sketch.sign[std::size_t(raw)] * block.data()[i];
    };
    for (const Probe& probe : probes) {
        const Eigen::VectorXd x = base + rows * probe.q;
        const bool is_hessian = probe.directions.cols() > 0;
        energy.evaluate(element, probe.w.data(), x.data(), is_hessian ? Order::hessian : Order::gradient, HessianKind::exact,
                        result);
        if (is_hessian)
            put(whitened_rows.transpose() * (result.hessian * (whitened_rows * probe.directions)), probe.scale);
        else
            put(whitened_rows.transpose() * result.gradient, probe.scale);
    }
}

std::vector<std::size_t> choose_candidates(std::size_t element_count, std::size_t wanted, std::uint64_t seed)
{
    std::vector<std::size_t> all(element_count);
    std::iota(all.begin(), all.end(), std::size_t(0));
    if (element_count <= wanted) return all;
    Random random(seed);
    for (std::size_t i = 0; i < wanted; ++i) std::swap(all[i], all[i + random.below(element_count - i)]);
    all.resize(wanted);
    std::sort(all.begin(), all.end());
    return all;
}

// What the rows of all elements together are: from the full mesh, probe by probe.
Eigen::VectorXd target_rows(const ReducedEnergy& reduced, const TrainingSet& training, const std::vector<Probe>& probes,
                            const Sketch& sketch, Progress* progress)
{
    Eigen::VectorXd target = Eigen::VectorXd::Zero(sketch.rows);
    Eigen::Index raw = 0;
    for (std::size_t p = 0; p < probes.size(); ++p) {
        if (progress) progress->update("cubature", 0.3 * double(p) / double(probes.size()), "targets");
        const Probe& probe = probes[p];
        Eigen::MatrixXd block;
        if (probe.directions.cols()) {
            block = training.root.transpose() * reduced.hessian(probe.w, probe.q, HessianKind::exact) * training.root
                * probe.directions;
        } else if (probe.scale
                   >= equilibrium_weight / std::sqrt(training.energy_scale * double(training.weights.size())) * 0.999) {
            block = Eigen::VectorXd::Zero(probe.q.size()); // an average: forces cancel, whatever the solver left over
        } else {
            Eigen::VectorXd gradient;
            reduced.gradient(probe.w, probe.q, gradient);
            block = training.root.transpose() * gradient;
        }
        for (Eigen::Index i = 0; i < block.size(); ++i, ++raw)
            target[sketch.target[std::size_t(raw)]] += probe.scale * sketch.sign[std::size_t(raw)] * block.data()[i];
    }
    return target;
}

} // namespace

void measure_curvature(const StandIn& stand_in, const TrainingSet& training, double& lowest, double& highest)
{
    lowest = 1e300;
    highest = 0;
    for (std::size_t t = 0; t < training.weights.size(); ++t) {
        const Eigen::MatrixXd h = training.root.transpose()
            * stand_in.hessian(training.weights[t], training.averages[t], HessianKind::exact) * training.root;
        const Eigen::VectorXd values
            = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(h, Eigen::EigenvaluesOnly).eigenvalues();
        lowest = std::min(lowest, values[0]);
        highest = std::max(highest, values[values.size() - 1]);
    }
}

StandIn fit_cubature(const ReducedEnergy& reduced, const TrainingSet& training, const CubatureOptions& options,
                     Progress* progress, CubatureReport& report)
{
    const Energy& energy = reduced.energy();
    const Subspace& subspace = reduced.subspace();
    const std::vector<Probe> probes = make_probes(training, options.seed);
    Eigen::Index raw_rows = 0;
    for (const Probe& probe : probes) raw_rows += probe.rows();
    const Sketch sketch = make_sketch(raw_rows, options.seed);
    const Eigen::VectorXd target = target_rows(reduced, training, probes, sketch, progress);

    const std::vector<std::size_t> candidates
        = choose_candidates(energy.element_count(), options.candidate_count, options.seed);
    report.candidate_count = candidates.size();
    const StandIn all(energy, subspace.origin, subspace.basis, candidates,
                      Eigen::VectorXd::Ones(Eigen::Index(candidates.size())));
    Eigen::MatrixXf columns(sketch.rows, Eigen::Index(candidates.size()));
    Eigen::VectorXd column(sketch.rows);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        if (progress && c % 256 == 0)
            progress->update("cubature", 0.3 + 0.4 * double(c) / double(candidates.size()), "training rows");
        fill_column(energy, candidates[c], all.origin_rows(c), all.rows(c), all.rows(c) * training.root, probes, sketch,
                    column);
        columns.col(Eigen::Index(c)) = column.cast<float>();
    }

    const std::size_t wanted = options.element_count ? options.element_count : 6 * std::size_t(subspace.dimension());
    const SparseFit fit = greedy_nnls(columns, target, std::min(wanted, candidates.size()), [&](std::size_t found) {
        if (progress)
            progress->update("cubature", 0.7 + 0.3 * double(found) / double(wanted),
                             fmt::format("{} of {} elements", found, wanted));
    });
    report.residual = fit.residual;
    std::vector<std::pair<std::size_t, double>> chosen;
    for (std::size_t i = 0; i < fit.columns.size(); ++i)
        chosen.push_back({ candidates[fit.columns[i]], fit.weights[Eigen::Index(i)] });
    std::sort(chosen.begin(), chosen.end());
    std::vector<std::size_t> elements;
    Eigen::VectorXd weights(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        elements.push_back(chosen[i].first);
        weights[Eigen::Index(i)] = chosen[i].second;
    }
    StandIn stand_in(energy, subspace.origin, subspace.basis, std::move(elements), std::move(weights));
    measure_curvature(stand_in, training, report.lowest_curvature, report.highest_curvature);
    return stand_in;
}

} // namespace pliant
