#include "reduced/surrogate/cubature.h"

#include "base/common/parallel.h"
#include "elastic/parts/tied_energy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <fmt/core.h>
#include <numeric>

namespace pliant {

namespace {

// Equilibrium decides where the minimum lies, so its rows count for more than forces elsewhere.
constexpr double equilibrium_weight = 30;

// Rows that the fit sees. More raw rows than this are mixed down by a sparse random projection, which keeps least squares
// over a few hundred columns intact (Clarkson, Woodruff 2013).
constexpr Eigen::Index sketch_rows = 2000;

// Averages at which forces of single poses and off the averages are looked at, too.
constexpr std::size_t force_probe_count = 40;

// Averages other than the mean at which columns of the Hessian are looked at, and how many columns.
constexpr std::size_t hessian_probe_count = 24;
constexpr Eigen::Index hessian_probe_columns = 6;

// An element that has less than this share of the most that one has of the training data hardly deforms: less than a
// thousandth as far, as forces times their slopes go with the square. In single precision, whose noise in angles and strains
// is about 1e-6, it would report little else, and a weight can make anything large: hinges of rigid limbs fold by rounding
// only, and weights made up for it.
constexpr float negligible_share = 1e-6f;

// Directions that are softer than this in whitened coordinates, where the true Hessian of the mean has 1, are checked
// against the true curvature; the surrogate energy should have at least half of it.
constexpr double soft_curvature = 0.3;
constexpr std::size_t stiffened_at_a_time = 32;

} // namespace

// What one block of rows evaluates at every element.
struct Probe {
    enum class Kind {
        equilibrium, // forces at an average, which cancel
        force,       // forces elsewhere
        hessian,     // the Hessian times directions
        curvature    // direction . Hessian . direction
    } kind;
    std::size_t average; // of the training set, at or near which this is
    Weights w;
    Eigen::VectorXd q;
    double scale;               // of the rows
    Eigen::MatrixXd directions; // d x c in whitened coordinates; empty for forces

    bool is_force() const { return kind == Kind::equilibrium || kind == Kind::force; }
    Eigen::Index rows() const
    {
        return is_force() ? q.size() : kind == Kind::hessian ? directions.size() : directions.cols();
    }
};

namespace {

// Weights at whose energy an average is no equilibrium: those of a pose; of layers, which may move little, other training
// weights.
std::vector<Weights> force_weights(const TrainingSet& training, const Energy& energy)
{
    return energy.blend() == Blend::layers ? training.weights : corner_weights_of(energy);
}

std::vector<Probe> make_probes(const TrainingSet& training, const Energy& energy, std::uint64_t seed)
{
    Random random(seed ^ 0x9e3779b97f4a7c15ull);
    const Eigen::Index d = training.whitening.rows();
    const double unit = 1 / std::sqrt(training.energy_scale); // forces in units of the root of the energy
    const std::vector<Weights> others = force_weights(training, energy);
    const std::size_t count = training.weights.size(), force_count = std::min(count, force_probe_count);
    std::vector<Probe> probes;
    const double share = unit / std::sqrt(double(count)), force_share = unit / std::sqrt(double(force_count));
    for (std::size_t t = 0; t < count; ++t) {
        const Weights& w = training.weights[t];
        const Eigen::VectorXd& q = training.averages[t];
        probes.push_back({ Probe::Kind::equilibrium, t, w, q, equilibrium_weight * share, {} });
        if (t >= force_count) continue;
        probes.push_back({ Probe::Kind::force, t, others[random.below(others.size())], q, force_share, {} });
        // Where the solver passes on its way: off the average by about the energy that the average has.
        Eigen::VectorXd z(d);
        for (Eigen::Index i = 0; i < d; ++i) z[i] = random.normal();
        z *= std::sqrt(training.energy_scale) * random.uniform() / std::max(z.norm(), 1e-30);
        probes.push_back({ Probe::Kind::force, t, w, q + training.whitening * z, force_share, {} });
    }
    // All of the Hessian at the mean, random directions of it elsewhere.
    probes.push_back({ Probe::Kind::hessian, 0, training.weights[0], training.averages[0], 1 / std::sqrt(double(d)),
                       Eigen::MatrixXd::Identity(d, d) });
    const std::size_t known = training.shapes.empty() ? count : training.exact_stiffness_count;
    for (std::size_t t = 1; t < std::min(known, hessian_probe_count + 1); ++t) {
        const Eigen::Index columns = std::min(d, hessian_probe_columns);
        Eigen::MatrixXd directions(d, columns);
        for (Eigen::Index i = 0; i < directions.size(); ++i) directions.data()[i] = random.normal() / std::sqrt(double(d));
        probes.push_back({ Probe::Kind::hessian, t, training.weights[t], training.averages[t],
                           0.5 / std::sqrt(double(columns)), directions });
    }
    return probes;
}

Eigen::Index row_count(const std::vector<Probe>& probes)
{
    Eigen::Index rows = 0;
    for (const Probe& probe : probes) rows += probe.rows();
    return rows;
}

} // namespace

// Where raw row r goes: itself if there are few rows, else a random one of sketch_rows with a random sign.
struct Sketch {
    std::vector<std::int32_t> target;
    std::vector<float> sign;
    Eigen::Index rows;
};

namespace {

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
        energy.evaluate(element, probe.w.data(), x.data(), probe.is_force() ? Order::gradient : Order::hessian,
                        HessianKind::exact, result);
        if (probe.is_force()) {
            put(whitened_rows.transpose() * result.gradient, probe.scale);
            continue;
        }
        const Eigen::MatrixXd moved = whitened_rows * probe.directions, product = result.hessian * moved;
        if (probe.kind == Probe::Kind::hessian)
            put(whitened_rows.transpose() * product, probe.scale);
        else
            put(moved.cwiseProduct(product).colwise().sum(), probe.scale);
    }
}

// `wanted` of the numbers first .. first + count - 1, all if there are no more.
void append_random(std::size_t first, std::size_t count, std::size_t wanted, Random& random, std::vector<std::size_t>& out)
{
    const std::size_t before = out.size();
    out.resize(before + std::min(wanted, count));
    std::iota(out.begin() + std::ptrdiff_t(before), out.end(), std::size_t(0));
    if (wanted < count) std::copy_n(random.distinct(count, wanted).begin(), wanted, out.begin() + std::ptrdiff_t(before));
    for (std::size_t i = before; i < out.size(); ++i) out[i] += first;
}

// Ties are few among many, and only they resist where parts move against each other: as many of them as may be half of all.
std::vector<std::size_t> choose_candidates(const Energy& energy, std::size_t wanted, std::uint64_t seed)
{
    const std::size_t inner = without_ties(energy).element_count(), ties = energy.element_count() - inner;
    const bool takes_all = energy.element_count() <= wanted;
    const std::size_t tie_count = takes_all ? ties : std::min(ties, wanted / 2);
    std::vector<std::size_t> out;
    Random random(seed);
    append_random(0, inner, takes_all ? inner : wanted - tie_count, random, out);
    append_random(inner, ties, tie_count, random, out);
    std::sort(out.begin(), out.end());
    return out;
}

// What the mesh does at a probe, whitened: the target of the weighted elements' rows. Training data from true averages take
// the mesh as it is at those: seen through the subspace its small triangles are creased, and their forces there mean
// nothing.
Eigen::MatrixXd target_of(const ReducedEnergy& reduced, const TrainingSet& training, const Probe& probe)
{
    const Subspace& subspace = reduced.subspace();
    const bool has_shapes = !training.shapes.empty();
    if (probe.kind == Probe::Kind::equilibrium)
        return Eigen::VectorXd::Zero(probe.q.size()); // forces cancel, whatever the solver left over
    if (probe.kind == Probe::Kind::force) {
        Shape shape = subspace.shape(probe.q);
        if (has_shapes) shape += *training.shapes[probe.average] - subspace.shape(training.averages[probe.average]);
        Shape gradient = Shape::Zero(shape.size());
        add_gradient(reduced.energy(), probe.w, shape, gradient);
        return training.whitening.transpose() * (subspace.basis.transpose() * gradient);
    }
    const Eigen::MatrixXd directions = training.whitening * probe.directions;
    const Eigen::MatrixXd product = training.whitening.transpose()
        * (has_shapes ? Eigen::MatrixXd(training.stiffness[probe.average] * directions)
                      : reduced.hessian_times(probe.w, probe.q, directions));
    if (probe.kind == Probe::Kind::hessian) return product;
    return probe.directions.cwiseProduct(product).colwise().sum();
}

// Blocks of rows that are larger than usual count as usual ones: a few creased triangles near an average can be stiffer than
// all the rest, and the fit would see nothing else. Usual are forces of the root of the energy, and the mean curvature, 1.
void limit_scale(Probe& probe, const Eigen::MatrixXd& target, double energy_scale)
{
    if (probe.kind == Probe::Kind::curvature) return;
    const double usual = probe.is_force() ? std::sqrt(energy_scale) : std::sqrt(double(target.cols()));
    probe.scale /= std::max(1.0, target.norm() / usual);
}

Eigen::VectorXd target_rows(const ReducedEnergy& reduced, const TrainingSet& training, std::vector<Probe>& probes,
                            const Sketch& sketch, Progress& progress)
{
    std::vector<Eigen::MatrixXd> blocks(probes.size());
    for_each_task(probes.size(), [&](std::size_t p, std::size_t) {
        progress.update("", 0);
        blocks[p] = target_of(reduced, training, probes[p]);
        limit_scale(probes[p], blocks[p], training.energy_scale);
    });
    Eigen::VectorXd target = Eigen::VectorXd::Zero(sketch.rows);
    Eigen::Index raw = 0;
    for (std::size_t p = 0; p < probes.size(); ++p)
        for (Eigen::Index i = 0; i < blocks[p].size(); ++i, ++raw)
            target[sketch.target[std::size_t(raw)]] += probes[p].scale * sketch.sign[std::size_t(raw)] * blocks[p].data()[i];
    return target;
}

// Whitened Hessian of the surrogate energy at a training average.
Eigen::MatrixXd whitened_hessian(const SurrogateEnergy& surrogate, const TrainingSet& training, std::size_t t)
{
    return training.whitening.transpose() * surrogate.hessian(training.weights[t], training.averages[t], HessianKind::exact)
        * training.whitening;
}

} // namespace

Curvature measure_curvature(const SurrogateEnergy& surrogate, const TrainingSet& training)
{
    std::vector<Curvature> all(training.weights.size());
    for_each_task(all.size(), [&](std::size_t t, std::size_t) {
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(
                                           whitened_hessian(surrogate, training, t), Eigen::EigenvaluesOnly)
                                           .eigenvalues();
        all[t] = { values[0], values[values.size() - 1] };
    });
    Curvature out = all[0];
    for (const Curvature& c : all) out = { std::min(out.lowest, c.lowest), std::max(out.highest, c.highest) };
    return out;
}

CubatureFit::CubatureFit(const ReducedEnergy& reduced, const TrainingSet& training, const CubatureOptions& options,
                         Progress* progress)
    : reduced_(reduced)
    , training_(training)
    , progress_(progress)
    , solver_(options.solver)
    , candidates_(choose_candidates(reduced.energy(), options.candidate_count, options.seed))
    , all_(reduced.energy(), reduced.subspace().rest, reduced.subspace().basis, candidates_,
           Eigen::VectorXd::Ones(Eigen::Index(candidates_.size())))
{
    std::vector<Probe> probes = make_probes(training, reduced.energy(), options.seed);
    const Sketch sketch = make_sketch(row_count(probes), options.seed);
    append_rows(std::move(probes), sketch);
}

void CubatureFit::append_rows(std::vector<Probe> probes, const Sketch& sketch)
{
    const Eigen::Index before = target_.size();
    SharedProgress shared(progress_);
    const double later = before > 0 ? 0.7 : 0; // rows that are added are few
    shared.describe("cubature", later, "targets");
    target_.conservativeResize(before + sketch.rows);
    target_.tail(sketch.rows) = target_rows(reduced_, training_, probes, sketch, shared);
    columns_.conservativeResize(before + sketch.rows, Eigen::Index(candidates_.size()));
    shared.describe("cubature", std::max(later, 0.3), "training rows");
    constexpr std::size_t block_size = 128; // candidates between two looks at the interrupt
    for_each_task((candidates_.size() + block_size - 1) / block_size, [&](std::size_t block, std::size_t) {
        shared.update("", 0);
        Eigen::VectorXd column(sketch.rows);
        for (std::size_t c = block * block_size; c < std::min(candidates_.size(), (block + 1) * block_size); ++c) {
            fill_column(reduced_.energy(), candidates_[c], all_.rest_rows(c), all_.rows(c),
                        all_.rows(c) * training_.whitening, probes, sketch, column);
            columns_.col(Eigen::Index(c)).tail(sketch.rows) = column.cast<float>();
        }
    });
    drop_negligible(before);
}

void CubatureFit::drop_negligible(Eigen::Index before)
{
    const float least = before > 0 ? 0 : negligible_share * columns_.colwise().norm().maxCoeff();
    for (Eigen::Index c = 0; c < columns_.cols(); ++c) {
        const float share = before > 0 ? columns_.col(c).head(before).norm() : columns_.col(c).norm();
        if (share <= least) columns_.col(c).setZero();
    }
}

SurrogateEnergy CubatureFit::fit(std::size_t element_count)
{
    const std::size_t wanted = std::min(element_count, candidates_.size());
    const auto report = [&](std::size_t found) {
        if (progress_)
            progress_->update("cubature", 0.7 + 0.3 * double(found) / double(wanted),
                              fmt::format("d = {}: {} of {} elements", reduced_.subspace().dimension(), found, wanted));
    };
    found_
        = (solver_ == CubatureSolver::nn_htp ? nn_htp : greedy_nnls)(columns_, target_, wanted, std::move(found_), report);
    std::vector<std::pair<std::size_t, double>> chosen;
    for (std::size_t i = 0; i < found_.columns.size(); ++i)
        chosen.push_back({ candidates_[found_.columns[i]], found_.weights[Eigen::Index(i)] });
    std::sort(chosen.begin(), chosen.end());
    std::vector<std::size_t> elements;
    Eigen::VectorXd weights(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        elements.push_back(chosen[i].first);
        weights[Eigen::Index(i)] = chosen[i].second;
    }
    const Subspace& subspace = reduced_.subspace();
    return SurrogateEnergy(reduced_.energy(), subspace.rest, subspace.basis, std::move(elements), std::move(weights));
}

std::size_t CubatureFit::stiffen(const SurrogateEnergy& surrogate)
{
    // The softest direction at every training average.
    std::vector<std::pair<double, Probe>> soft(training_.weights.size());
    for_each_task(soft.size(), [&](std::size_t t, std::size_t) {
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(whitened_hessian(surrogate, training_, t));
        soft[t]
            = { eigen.eigenvalues()[0],
                { Probe::Kind::curvature, t, training_.weights[t], training_.averages[t], 1, eigen.eigenvectors().col(0) } };
    });
    std::sort(soft.begin(), soft.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::size_t count = 0;
    while (count < std::min(soft.size(), stiffened_at_a_time) && soft[count].first < soft_curvature) ++count;
    std::vector<double> wanted(count);
    for_each_task(count,
                  [&](std::size_t i, std::size_t) { wanted[i] = target_of(reduced_, training_, soft[i].second)(0, 0); });
    std::vector<Probe> probes;
    for (std::size_t i = 0; i < count; ++i)
        if (soft[i].first < 0.5 * wanted[i]) probes.push_back(soft[i].second);
    if (probes.empty()) return 0;
    Sketch plain; // every row on its own: these must not drown
    plain.rows = row_count(probes);
    for (Eigen::Index r = 0; r < plain.rows; ++r) plain.target.push_back(std::int32_t(r)), plain.sign.push_back(1.f);
    const std::size_t added = probes.size();
    append_rows(std::move(probes), plain);
    return added;
}

} // namespace pliant
