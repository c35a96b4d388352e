#include "pipeline.h"

#include "bake/assemble.h"
#include "bake/make_energy.h"
#include "output/asset/runtime_blender.h"
#include "reduced/subspace/krylov.h"
#include "reduced/surrogate/cubature.h"

#include <chrono>
#include <fmt/core.h>
#include <numeric>

namespace pliant {

namespace {

using Clock = std::chrono::steady_clock;

double elapsed(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr std::size_t points_per_dimension = 3; // the paper's
constexpr std::size_t pipeline_training_count = 16;
constexpr std::size_t drag_corners = 8, frames_per_side = 60; // of the path of weights

// A sum of all elements, seen through a basis.
std::shared_ptr<const SurrogateEnergy> all_elements(const Energy& energy, const Shape& rest, const Eigen::MatrixXd& basis)
{
    std::vector<std::size_t> elements(energy.element_count());
    std::iota(elements.begin(), elements.end(), std::size_t(0));
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(Eigen::Index(elements.size()));
    return std::make_shared<const SurrogateEnergy>(energy, rest, basis, std::move(elements), ones);
}

// The surrogate energy's own averages, from the linear blends by BFGS in the metric of its Hessian at the mean.
TrainingSet train(const SurrogateEnergy& surrogate, const Subspace& subspace)
{
    TrainingSet training;
    training.weights = training_weights(std::size_t(subspace.pose_coordinates.cols()), pipeline_training_count, 1);
    const Weights equal = training.weights[0];
    const MinimizeResult mean = minimize_newton(surrogate, equal, subspace.pose_coordinates * equal, 1e-6);
    training.whitening = whitening_of(surrogate.hessian(equal, mean.q, HessianKind::projected), metric_floor);
    training.energy_scale = std::max(mean.value, 1e-13);
    MinimizeOptions options;
    options.scale = training.energy_scale;
    for (const Weights& w : training.weights) {
        const auto energy = [&](const Eigen::VectorXd& q, Eigen::VectorXd& g) { return surrogate.gradient(w, q, g); };
        const MinimizeResult found
            = minimize(energy, subspace.pose_coordinates * w, training.whitening * training.whitening.transpose(), options);
        training.unconverged_count += !found.has_converged;
        training.averages.push_back(found.q);
    }
    return training;
}

// For cubature: reduced averages on the full mesh, in the metric of its Hessian half way between the poses.
ReducedSolver solver_of(const Energy& energy, const NormalizedPoses& set, const Subspace& subspace)
{
    const Weights equal = Weights::Constant(Eigen::Index(set.pose_count()), 1.0 / double(set.pose_count()));
    const Shape middle = subspace.shape(subspace.pose_coordinates * equal);
    HessianAssembler hessian(energy);
    hessian.assemble(equal, middle, HessianKind::projected);
    return ReducedSolver(energy, subspace, hessian.matrix(), energy_value(energy, equal, middle));
}

// Seconds for frames and how many steps they took, as a user drags.
struct Drag {
    double shape_us = 0, step_us = 0, steps = 0, vertices_ms = 0;
};

Drag drag(RuntimeBlender& blender, std::size_t pose_count)
{
    Random random(5);
    Drag out;
    std::vector<float> q;
    Weights from = random_weights(random, pose_count, false);
    const double count = double(drag_corners * frames_per_side);
    double seconds = 0;
    for (std::size_t corner = 0; corner < drag_corners; ++corner) {
        const Weights to = random_weights(random, pose_count, false);
        for (std::size_t frame = 0; frame < frames_per_side; ++frame) {
            const Eigen::VectorXf w = (from + (to - from) * double(frame) / double(frames_per_side)).cast<float>();
            pliant_solve_info info {};
            const std::vector<float> weights(w.data(), w.data() + w.size());
            const Clock::time_point start = Clock::now();
            q = blender.solve(weights, true, &info);
            seconds += elapsed(start);
            out.steps += info.iterations / count;
        }
        from = to;
    }
    const Clock::time_point start = Clock::now();
    for (int i = 0; i < 10; ++i) blender.positions(q);
    out.vertices_ms = 100 * elapsed(start);
    out.shape_us = 1e6 * seconds / count;
    out.step_us = out.shape_us / std::max(out.steps, 1e-9);
    return out;
}

class Pipeline {
public:
    Pipeline(const PoseSet& poses, const EnergyOptions& options, Eigen::Index dimension)
        : poses_(poses)
        , options_(options)
        , set_(normalize(poses))
        , energy_(make_energy(set_, options))
    {
        NewtonSolver solver(*energy_, set_, default_solver());
        const Clock::time_point start = Clock::now();
        fitted_.subspace = build_krylov_subspace(solver, { 0, dimension, 256 }, nullptr);
        basis_s_ = elapsed(start);
    }

    std::string csv()
    {
        const Clock::time_point start = Clock::now();
        const auto surrogate = make_surrogate();
        const double surrogate_s = elapsed(start);
        fitted_.model = plain_model(surrogate, fitted_.training, fitted_.subspace);
        RuntimeBlender blender = open();
        const Drag measured = drag(blender, set_.pose_count());
        return fmt::format(
            "vertices,cells,poses,d,surrogate,elements,unconverged,basis_s,surrogate_s,steps,step_us,shape_us,vertices_ms\n"
            "{},{},{},{},{},{},{},{:.4f},{:.4f},{:.2f},{:.3f},{:.3f},{:.3f}\n",
            set_.dof_count() / 3, poses_.is_solid() ? set_.tets.size() : set_.triangles.size(), set_.pose_count(),
            fitted_.subspace.dimension(), kind_, surrogate->element_count(), fitted_.training.unconverged_count, basis_s_,
            surrogate_s, measured.steps, measured.step_us, measured.shape_us, measured.vertices_ms);
    }

private:
    std::shared_ptr<const SurrogateEnergy> make_surrogate()
    {
        const auto* solid = dynamic_cast<const Solid*>(energy_.get());
        if (solid && solid->law() == SolidLaw::mooney_rivlin) return make_cubature();
        kind_ = solid ? "quartic" : "ghost";
        auto surrogate = solid
            ? std::make_shared<const SurrogateEnergy>(*energy_, Quartic(*solid, fitted_.subspace, nullptr))
            : make_ghost_surrogate();
        fitted_.training = train(*surrogate, fitted_.subspace);
        return surrogate;
    }

    std::shared_ptr<const SurrogateEnergy> make_ghost_surrogate()
    {
        fitted_.ghost = std::make_unique<Ghost>(make_ghost(set_, fitted_.subspace, BakeOptions().ghost_vertex_count));
        fitted_.ghost_energy = make_energy(fitted_.ghost->set, options_);
        return all_elements(*fitted_.ghost_energy, fitted_.ghost->set.shapes[0], fitted_.ghost->basis);
    }

    std::shared_ptr<const SurrogateEnergy> make_cubature()
    {
        kind_ = "cubature";
        const ReducedSolver reduced = solver_of(*energy_, set_, fitted_.subspace);
        fitted_.training
            = solve_training_set(reduced, set_, training_weights(set_.pose_count(), pipeline_training_count, 1), nullptr);
        CubatureFit fit(reduced.energy(), fitted_.training, { 8000, CubatureSolver::nn_htp, 1 }, nullptr);
        return std::make_shared<const SurrogateEnergy>(
            fit.fit(points_per_dimension * std::size_t(fitted_.subspace.dimension())));
    }

    RuntimeBlender open() const
    {
        BakeOptions options;
        options.position_error = 0;
        const AssetModel asset
            = assemble(set_, WeightDomain::simplex(set_.pose_count()), fitted_, simulation_mesh(poses_, set_, options),
                       poses_, reachable_coordinates(fitted_), options);
        AssetRecord record; // the format wants an answer; nothing here asks for it
        record.answers = { { fitted_.training.weights[0], asset.shape.frame.stored(fitted_.model.mean).cast<float>() } };
        return RuntimeBlender(encode_asset(asset, record), "the asset");
    }

    const PoseSet& poses_;
    const EnergyOptions& options_;
    NormalizedPoses set_;
    std::unique_ptr<Energy> energy_;
    FittedModel fitted_;
    double basis_s_ = 0;
    std::string kind_;
};

} // namespace

std::string pipeline_csv(const PoseSet& poses, const EnergyOptions& options, Eigen::Index dimension)
{
    return Pipeline(poses, options, dimension).csv();
}

} // namespace pliant
