#include "cubatures.h"

#include "base/common/parallel.h"
#include "reduced/surrogate/blend_model.h"
#include "reduced/surrogate/cubature.h"

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <fmt/core.h>
#include <functional>
#include <numeric>

namespace pliant {

namespace {

// A surrogate energy of any make, in the coordinates of the subspace.
struct Surrogate {
    std::string name;
    std::size_t element_count; // evaluated for one gradient
    double seconds;            // of the training
    std::function<double(const Weights&, const Eigen::VectorXd&, Eigen::VectorXd&)> gradient;
    std::function<Eigen::MatrixXd(const Weights&, const Eigen::VectorXd&)> hessian;
};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::vector<std::size_t> random_elements(std::size_t count, std::size_t wanted, std::uint64_t seed)
{
    std::vector<std::size_t> all = Random(seed).distinct(count, std::min(count, wanted));
    std::sort(all.begin(), all.end());
    return all;
}

// The training problem of one example pose: forces of W_k at training poses, those of every pose scaled to unit length (An
// et al. 2008), by elements (columns) and of the mesh (target).
struct ForceRows {
    Eigen::MatrixXf columns;
    Eigen::VectorXd target;
};

class PoseCubature {
public:
    PoseCubature(const ReducedSolver& reduced, std::size_t pose, const Eigen::VectorXd& mean, const CubatureStudy& options)
        : reduced_(reduced.energy())
        , corner_(corner_weights(std::size_t(reduced_.subspace().pose_coordinates.cols()), pose))
        , candidates_(random_elements(reduced_.energy().element_count(), options.candidate_count, options.seed))
        , all_(surrogate_of(candidates_, Eigen::VectorXd::Ones(Eigen::Index(candidates_.size()))))
    {
        draw(reduced_.subspace().pose_coordinates.col(Eigen::Index(pose)), mean, options);
        evaluate();
    }

    SurrogateEnergy fit(CubatureSolver solver, std::size_t element_count) const
    {
        const auto find = solver == CubatureSolver::nn_htp ? nn_htp : greedy_nnls;
        const SparseFit fit = find(rows_.columns, rows_.target, element_count, {}, [](std::size_t) {});
        std::vector<std::size_t> elements;
        for (std::size_t column : fit.columns) elements.push_back(candidates_[column]);
        return surrogate_of(std::move(elements), fit.weights);
    }

private:
    SurrogateEnergy surrogate_of(std::vector<std::size_t> elements, Eigen::VectorXd weights) const
    {
        const Subspace& subspace = reduced_.subspace();
        return SurrogateEnergy(reduced_.energy(), subspace.rest, subspace.basis, std::move(elements), std::move(weights));
    }

    // Training poses are normal in the metric of W_k's Hessian at the example pose, with up to the energy that W_k has at
    // the average of all poses, so that they lie as far away as blends do.
    void draw(const Eigen::VectorXd& pose, const Eigen::VectorXd& mean, const CubatureStudy& options)
    {
        Eigen::VectorXd unused;
        const double most = reduced_.gradient(corner_, mean, unused);
        const Eigen::MatrixXd whitening = whitening_of(reduced_.hessian(corner_, pose, HessianKind::exact), metric_floor);
        Random random(options.seed);
        for (std::size_t t = 0; t < options.pose_count; ++t) {
            Eigen::VectorXd z(pose.size());
            for (double& value : z) value = random.normal();
            poses_.push_back(pose + whitening * z * std::sqrt(2 * most * random.uniform()) / std::max(z.norm(), 1e-30));
        }
    }

    void evaluate()
    {
        const Eigen::Index d = reduced_.subspace().dimension(), rows = d * Eigen::Index(poses_.size());
        std::vector<double> scales(poses_.size());
        rows_.target.resize(rows);
        for_each_task(poses_.size(), [&](std::size_t t, std::size_t) {
            Eigen::VectorXd force;
            const double value = reduced_.gradient(corner_, poses_[t], force), norm = force.norm();
            scales[t] = std::isfinite(value) && norm > 0 ? 1 / norm : 0; // a tetrahedron may be inverted there
            rows_.target.segment(Eigen::Index(t) * d, d)
                = scales[t] > 0 ? Eigen::VectorXd(scales[t] * force) : Eigen::VectorXd(Eigen::VectorXd::Zero(d));
        });
        rows_.columns.resize(rows, Eigen::Index(candidates_.size()));
        for_each_task(candidates_.size(), [&](std::size_t c, std::size_t) { fill(c, scales); });
    }

    void fill(std::size_t candidate, const std::vector<double>& scales)
    {
        const Eigen::MatrixXd& rows = all_.rows(candidate);
        ElementResult result;
        for (std::size_t t = 0; t < poses_.size(); ++t) {
            const Eigen::VectorXd x = all_.rest_rows(candidate) + rows * poses_[t];
            auto block = rows_.columns.col(Eigen::Index(candidate)).segment(Eigen::Index(t) * rows.cols(), rows.cols());
            block.setZero();
            if (scales[t] == 0) continue;
            reduced_.energy().evaluate(candidates_[candidate], corner_.data(), x.data(), Order::gradient, HessianKind::exact,
                                       result);
            block = (scales[t] * (rows.transpose() * result.gradient)).cast<float>();
        }
    }

    const ReducedEnergy& reduced_;
    Weights corner_;
    std::vector<std::size_t> candidates_;
    SurrogateEnergy all_; // the candidates at weight 1
    std::vector<Eigen::VectorXd> poses_;
    ForceRows rows_;
};

// sum_k w_k (elements of pose k): nothing is combined over poses.
Surrogate per_pose(std::string name, std::vector<SurrogateEnergy> parts, double seconds)
{
    std::size_t count = 0;
    for (const SurrogateEnergy& part : parts) count += part.element_count();
    const auto all = std::make_shared<const std::vector<SurrogateEnergy>>(std::move(parts));
    return { std::move(name), count, seconds,
             [all](const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) {
                 double value = 0;
                 Eigen::VectorXd part;
                 gradient.setZero(q.size());
                 for (std::size_t k = 0; k < all->size(); ++k) {
                     const double share = w[Eigen::Index(k)];
                     value += share * (*all)[k].gradient(corner_weights(all->size(), k), q, part);
                     gradient += share * part;
                 }
                 return value;
             },
             [all](const Weights& w, const Eigen::VectorXd& q) {
                 Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(q.size(), q.size());
                 for (std::size_t k = 0; k < all->size(); ++k)
                     sum += w[Eigen::Index(k)] * (*all)[k].hessian(corner_weights(all->size(), k), q, HessianKind::exact);
                 return sum;
             } };
}

Surrogate joint(std::string name, std::shared_ptr<const SurrogateEnergy> energy, double seconds)
{
    return { std::move(name), energy->element_count(), seconds,
             [energy](const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& g) { return energy->gradient(w, q, g); },
             [energy](const Weights& w, const Eigen::VectorXd& q) { return energy->hessian(w, q, HessianKind::exact); } };
}

// `plain` with the dead load, a linear term.
Surrogate with_load(const Surrogate& plain, std::shared_ptr<const SurrogateEnergy> energy, const TrainingSet& training,
                    const Subspace& subspace)
{
    const auto model = std::make_shared<const BlendModel>(loaded_model(std::move(energy), training, subspace));
    const Eigen::MatrixXd to_q = model->whitening.transpose().inverse();
    Surrogate out = plain;
    out.name += ", dead load";
    out.gradient = [plain, model, to_q](const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) {
        const double value = plain.gradient(w, q, gradient);
        const Eigen::VectorXd load = to_q * (*model->load)(w);
        gradient += load;
        return value + load.dot(q - model->mean);
    };
    return out;
}

std::vector<Surrogate> surrogates_of(const ReducedSolver& reduced, const TrainingSet& training, const CubatureStudy& options)
{
    const std::size_t m = std::size_t(training.weights[0].size()),
                      count = options.points_per_dimension * std::size_t(reduced.subspace().dimension());
    struct Way {
        CubatureSolver solver;
        const char* name;
    };
    const Way ways[] = { { CubatureSolver::nn_htp, "NN-HTP" }, { CubatureSolver::nnls, "greedy" } };
    std::vector<std::vector<SurrogateEnergy>> parts(2);
    double seconds[2] = { 0, 0 };
    for (std::size_t k = 0; k < m; ++k) {
        const Clock::time_point start = Clock::now();
        const PoseCubature pose(reduced, k, training.averages[0], options);
        const double rows = seconds_since(start);
        for (std::size_t i = 0; i < 2; ++i) {
            const Clock::time_point fit_start = Clock::now();
            parts[i].push_back(pose.fit(ways[i].solver, count));
            seconds[i] += rows + seconds_since(fit_start);
        }
    }
    std::vector<Surrogate> out;
    for (std::size_t i = 0; i < 2; ++i)
        out.push_back(per_pose(fmt::format("per pose, {}", ways[i].name), std::move(parts[i]), seconds[i]));
    for (const Way& way : ways) {
        const Clock::time_point start = Clock::now();
        CubatureFit fit(reduced.energy(), training, { options.candidate_count, way.solver, options.seed }, nullptr);
        for (std::size_t factor : { std::size_t(1), m }) {
            if (factor > 1 && way.solver == CubatureSolver::nn_htp) break;
            const auto energy = std::make_shared<const SurrogateEnergy>(fit.fit(factor * count));
            out.push_back(joint(fmt::format("joint, {}", way.name), energy, seconds_since(start)));
            if (factor > 1) out.push_back(with_load(out.back(), energy, training, reduced.subspace()));
        }
    }
    return out;
}

// Both metrics in which BFGS starts, and where.
struct Start {
    Eigen::VectorXd mean;
    Eigen::MatrixXd at_mean, averaged;
};

Eigen::MatrixXd metric_of(const Eigen::MatrixXd& hessian)
{
    const Eigen::MatrixXd whitening = whitening_of(hessian, metric_floor);
    return whitening * whitening.transpose();
}

MinimizeResult solve(const Surrogate& surrogate, const Weights& w, const Eigen::VectorXd& start,
                     const Eigen::MatrixXd& metric, double energy_scale)
{
    MinimizeOptions options;
    options.scale = energy_scale;
    return minimize([&](const Eigen::VectorXd& q, Eigen::VectorXd& g) { return surrogate.gradient(w, q, g); }, start, metric,
                    options);
}

Start start_of(const Surrogate& surrogate, const TrainingSet& training)
{
    const Eigen::MatrixXd metric = training.whitening * training.whitening.transpose();
    Start start;
    start.mean = solve(surrogate, training.weights[0], training.averages[0], metric, training.energy_scale).q;
    start.at_mean = metric_of(surrogate.hessian(training.weights[0], start.mean));
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(metric.rows(), metric.cols());
    for (std::size_t t = 0; t < training.weights.size(); ++t)
        sum += surrogate.hessian(training.weights[t], training.averages[t]);
    start.averaged = metric_of(sum / double(training.weights.size()));
    return start;
}

} // namespace

std::string cubature_rows(const ReducedSolver& reduced, const NormalizedPoses& set, const TrainingSet& training,
                          const std::vector<Reference>& references, const Eigen::MatrixXd& exact,
                          const CubatureStudy& options)
{
    const Subspace& subspace = reduced.subspace();
    std::string csv = "cubature,d,elements,training_s,kind,weights,surrogate_l2,total_l2,iterations_h0_at_mean,"
                      "iterations_h0_averaged,has_converged\n";
    for (const Surrogate& surrogate : surrogates_of(reduced, training, options)) {
        const Start start = start_of(surrogate, training);
        for (std::size_t i = 0; i < references.size(); ++i) {
            const Weights& w = references[i].weights;
            const MinimizeResult at_mean = solve(surrogate, w, start.mean, start.at_mean, training.energy_scale),
                                 averaged = solve(surrogate, w, start.mean, start.averaged, training.energy_scale);
            const Shape blend = subspace.shape(averaged.q);
            csv += fmt::format("\"{}\",{},{},{:.2f},{},{},{:.6e},{:.6e},{},{},{}\n", surrogate.name, subspace.dimension(),
                               surrogate.element_count, surrogate.seconds, references[i].kind,
                               weights_cell(references[i].weights),
                               relative_distance(set, blend, subspace.shape(exact.col(Eigen::Index(i)))),
                               relative_distance(set, blend, references[i].shape), at_mean.iterations, averaged.iterations,
                               int(at_mean.has_converged && averaged.has_converged));
        }
    }
    return csv;
}

} // namespace pliant
