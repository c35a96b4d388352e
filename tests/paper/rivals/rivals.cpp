// Ways to blend poses side by side, unreduced, and the runtime's: how good each is, and how long a shape takes.
//   pliant_rivals -o PREFIX [--asset FILE] [--material M] POSE...
//   pliant_rivals -o PREFIX --bar bend120|twist180|twist360
// Writes PREFIX.csv, a row per way and weights, and PREFIX_WAY.ply at equal weights. Surfaces only.
#include "../../baker/tube.h"
#include "../../baker/twisted_bar.h"
#include "quality.h"
#include "rival.h"

#include "bake/make_energy.h"
#include "base/mesh/align.h"
#include "base/weights/sampling.h"
#include "elastic/average/family.h"
#include "elastic/average/shape_error.h"
#include "input/io/encode_ply.h"
#include "input/io/write_file.h"
#include "input/poses/load_poses.h"
#include "output/asset/runtime_blender.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fmt/core.h>
#include <functional>
#include <map>

using namespace pliant;

namespace {

struct Options {
    std::vector<std::string> poses;
    std::string prefix, asset, bar;
    int cells = 6, fresh_count = 3;
};

double seconds_of(const std::function<void()>& work)
{
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The surface of a bar 1 x 1 x 6, straight and bent or twisted.
PoseSet bar_poses(const std::string& name, int cells)
{
    struct Kind {
        double bend, twist;
    };
    constexpr double degree = 3.14159265358979323846 / 180;
    static const std::map<std::string, Kind> kinds { { "bend120", { 120 * degree, 0 } },
                                                     { "twist180", { 0, 180 * degree } },
                                                     { "twist360", { 0, 360 * degree } } };
    const PoseSet solid = twisted_bar(cells, 6 * cells, 0);
    std::vector<std::uint32_t> numbers(std::size_t(solid.positions[0].rows()), ~0u);
    std::vector<Eigen::RowVector3d> points;
    PoseSet poses;
    for (Triangle t : solid.triangles) {
        for (std::uint32_t& v : t) {
            if (numbers[v] == ~0u) {
                numbers[v] = std::uint32_t(points.size());
                points.push_back(solid.positions[0].row(v));
            }
            v = numbers[v];
        }
        poses.triangles.push_back(t);
    }
    poses.polygons = to_polygons(poses.triangles);
    poses.names = poses.paths = { "straight", name };
    poses.positions.assign(2, Positions(Eigen::Index(points.size()), 3));
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::RowVector3d& p = points[i];
        poses.positions[0].row(Eigen::Index(i)) = p;
        poses.positions[1].row(Eigen::Index(i))
            = Tube::place(kinds.at(name).bend, kinds.at(name).twist, p.z(), p.x(), p.y());
    }
    return poses;
}

// Elastic averages of an energy of ours: the reference, and as-rigid-as-possible.
class Elastic final : public Rival {
public:
    Elastic(const NormalizedPoses& set, Material material, RivalTraits traits)
        : model_(make_model(set, options_of(material)))
        , pool_(*model_.energy, set, default_solver())
        , family_(pool_, NewtonOptions(), nullptr, {}, model_.coarse.get())
        , traits_(traits)
    {
        family_.mean();
    }
    const RivalTraits& traits() const override { return traits_; }
    Shape blend(const Weights& w) override { return family_.at(w, 0, nullptr).average.y; }

private:
    static EnergyOptions options_of(Material material)
    {
        EnergyOptions options;
        options.material = material;
        options.continuity = Continuity::off;
        return options;
    }
    ElasticModel model_;
    SolverPool pool_;
    AverageFamily family_;
    RivalTraits traits_;
};

// An asset's blends by the runtime.
class Reduced final : public Rival {
public:
    Reduced(const NormalizedPoses& set, const std::string& path)
        : set_(set)
        , blender_(RuntimeBlender::from_file(path))
    {
    }
    const RivalTraits& traits() const override
    {
        static const RivalTraits traits { "Pliant", "the runtime", true, true, "the averages branch" };
        return traits;
    }
    Shape blend(const Weights& w) override
    {
        const Eigen::VectorXf shares = w.cast<float>();
        const std::vector<float> given(shares.data(), shares.data() + shares.size());
        return from_input_units(set_, blender_.positions(blender_.solve(given, false)));
    }

private:
    const NormalizedPoses& set_;
    RuntimeBlender blender_;
};

using Maker = std::function<std::unique_ptr<Rival>(const NormalizedPoses&)>;

// The reference comes first.
std::vector<Maker> makers(const std::string& asset)
{
    const auto elastic = [](Material material, const RivalTraits& traits) -> Maker {
        return [=](const NormalizedPoses& set) { return std::make_unique<Elastic>(set, material, traits); };
    };
    std::vector<Maker> out { elastic(Material::discrete_shells,
                                     { "elastic average", "von Tycowicz et al. 2015, unreduced", true, true,
                                       "the averages branch" }),
                             make_linear,
                             make_gradient_domain,
                             make_connection_maps,
                             make_lengths_and_angles,
                             elastic(Material::arap,
                                     { "as-rigid-as-possible", "Sorkine and Alexa 2007, averaged", true, true,
                                       "triangles fold: it has no bending" }) };
    if (!asset.empty()) out.push_back([=](const NormalizedPoses& set) { return std::make_unique<Reduced>(set, asset); });
    return out;
}

std::string file_name(std::string name)
{
    std::replace(name.begin(), name.end(), ' ', '_');
    return name;
}

std::vector<Weights> weights_of(std::size_t pose_count, int fresh_count)
{
    std::vector<Weights> weights { equal_weights(pose_count) };
    const std::vector<Weights> fresh = draw_weights(7, pose_count, fresh_count);
    weights.insert(weights.end(), fresh.begin(), fresh.end());
    return weights;
}

class Comparison {
public:
    Comparison(const PoseSet& poses, const Options& options)
        : poses_(poses)
        , options_(options)
        , set_(normalize(poses))
        , meter_(set_)
        , weights_(weights_of(set_.pose_count(), options.fresh_count))
    {
    }

    void run()
    {
        for (const Maker& make : makers(options_.asset)) {
            try {
                add_rows(make);
            } catch (const Failure& failure) { // of an energy that this mesh does not have
                fmt::print(stderr, "pliant_rivals: {}\n", failure.diagnostics()[0].what);
            }
        }
        write_file_atomically(options_.prefix + ".csv", csv_);
    }

private:
    void add_rows(const Maker& make)
    {
        std::unique_ptr<Rival> rival;
        const double setup = seconds_of([&] { rival = make(set_); });
        const RivalTraits& traits = rival->traits();
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            Shape blend;
            const double seconds = seconds_of([&] { blend = rival->blend(weights_[i]); });
            align_to(set_, set_.shapes[0], blend);
            if (references_.size() <= i) references_.push_back(blend);
            const BlendQuality quality = meter_.measure(weights_[i], blend);
            csv_ += fmt::format("{},\"{}\",{},{:.3e},{:.3e},{:.4e},{:.4e},{:.4e},{:.4f},{:.4e},{},{},\"{}\"\n", traits.name,
                                traits.source, i, setup, seconds, quality.strain, quality.volume, quality.limb_length,
                                quality.worst_triangle, relative_distance(set_, blend, references_[i]),
                                traits.takes_many ? "yes" : "no", traits.is_order_free ? "yes" : "no", traits.fails);
            if (i == 0)
                write_file_atomically(fmt::format("{}_{}.ply", options_.prefix, file_name(traits.name)),
                                      encode_ply(to_input_units(set_, blend), poses_.polygons));
        }
        fmt::print(stderr, "pliant_rivals: {}: {:.3g} s to set up\n", traits.name, setup);
    }

    const PoseSet& poses_;
    const Options& options_;
    NormalizedPoses set_;
    QualityMeter meter_;
    std::vector<Weights> weights_;
    std::vector<Shape> references_;
    std::string csv_ = "way,source,weights,setup_s,shape_s,strain,volume,limb_length,worst_triangle,from_elastic,"
                       "many_poses,order_free,fails_when\n";
};

} // namespace

int main(int argc, char** argv)
{
    Options options;
    CLI::App app("Ways to blend poses, side by side");
    app.add_option("poses", options.poses, "Pose files");
    app.add_option("-o,--output", options.prefix, "Prefix of what is written")->required()->type_name("PREFIX");
    app.add_option("--asset", options.asset, "Also the runtime's blends of this asset of the same poses");
    app.add_option("--bar", options.bar, "A bar instead of files")
        ->check(CLI::IsMember({ "bend120", "twist180", "twist360" }));
    app.add_option("--cells", options.cells, "Of the bar, across")->check(CLI::Range(1, 64))->capture_default_str();
    app.add_option("--fresh", options.fresh_count, "Weights beside the equal ones")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        const PoseSet poses = options.bar.empty() ? load_poses(options.poses) : bar_poses(options.bar, options.cells);
        Comparison(poses, options).run();
    } catch (const Failure& failure) {
        for (const Diagnostic& diagnostic : failure.diagnostics())
            fmt::print(stderr, "pliant_rivals: {}\n", diagnostic.what);
        return 1;
    } catch (const std::exception& error) {
        fmt::print(stderr, "pliant_rivals: {}\n", error.what());
        return 1;
    }
    return 0;
}
