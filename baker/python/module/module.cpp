// The module pliant._core: what the Python files of the package stand on. Arguments have been looked at there; here is
// checked what memory depends on.
#include "arrays.h"
#include "asset_view.h"
#include "checks.h"
#include "energy_view.h"
#include "options.h"
#include "unlocked.h"
#include "work.h"

#include "bake/bake.h"
#include "bake/certificate.h"
#include "bake/make_energy.h"
#include "bake/warnings.h"
#include "base/common/parallel.h"
#include "base/common/version.h"
#include "input/io/source_file.h"
#include "input/io/write_file.h"
#include "input/poses/load_render_mesh.h"
#include "input/poses/pose_source.h"
#include "output/asset/runtime_blender.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace pliant {
namespace {

// Failure becomes what the package makes of it.
void raise_failure(const Failure& failure)
{
    nb::list diagnostics;
    for (const Diagnostic& f : failure.diagnostics())
        diagnostics.append(
            nb::make_tuple(f.severity == Diagnostic::Severity::error, f.number, nb::str(f.where.c_str()), f.what, f.hint));
    const nb::object make = nb::module_::import_("pliant._errors").attr("from_findings"),
                     code = nb::int_(int(failure.code()));
    PyObject* error;
    {
        PythonCall call;
        error = PyObject_CallFunctionObjArgs(make.ptr(), code.ptr(), diagnostics.ptr(), nullptr);
        call.has_ended = true;
    }
    if (!error) throw nb::python_error();
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error)), error);
    Py_DECREF(error);
}

void translate(const std::exception_ptr& exception, void*)
{
    try {
        std::rethrow_exception(exception);
    } catch (const Failure& failure) {
        raise_failure(failure);
    }
}

SourcePoses load_sources(const std::vector<std::string>& paths, std::optional<Blend> blend, const Listener& listener)
{
    SourcePoses out;
    work_interruptibly(listener, 0, [&](Progress& progress) {
        DiagnosticList diagnostics;
        PoseSources sources = read_pose_sources(paths, blend, diagnostics);
        out = { std::move(sources.meshes), sources.blend, sources.share_frame };
        if (diagnostics.has_errors()) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
        report_warnings(diagnostics.diagnostics(), progress);
    });
    return out;
}

// Passes on what it hears, and keeps the warnings for the report.
class KeepingProgress final : public Progress {
public:
    explicit KeepingProgress(Progress& target)
        : target_(target)
    {
    }
    void update(const std::string& stage, double fraction, const std::string& detail) override
    {
        target_.update(stage, fraction, detail);
    }
    void warn(int number, const std::string& what, const std::string& hint) override
    {
        kept_.push_back(warning_at(number, "", what, hint));
        target_.warn(number, what, hint);
    }
    const std::vector<Diagnostic>& kept() const { return kept_; }

private:
    Progress& target_;
    std::vector<Diagnostic> kept_;
};

// The bytes, the report as JSON, and what misses the tolerance, if that is so and is to be no error.
nb::object bake_poses(const SourcePoses& poses, const nb::dict& given, const SourcePoses* surface,
                      const std::string& surface_path, const Listener& listener)
{
    BakeOptions options = bake_options(given);
    const bool has_tolerance = given.contains("tolerance"),
               is_best_effort = given.contains("best_effort") || options.time_limit;
    const unsigned threads = given.contains("threads") ? nb::cast<unsigned>(given["threads"]) : 0;
    BakedAsset baked;
    std::optional<ToleranceMiss> miss;
    std::vector<Diagnostic> warnings;
    work_interruptibly(listener, threads, [&](Progress& progress) {
        const PoseSet set = check(poses, options.energy, warnings, progress);
        std::vector<Diagnostic> of_surface;
        if (surface)
            options.render_mesh
                = std::make_shared<const RenderMesh>(embed_render_mesh(surface->meshes.at(0), set, &of_surface));
        else if (!surface_path.empty())
            options.render_mesh = std::make_shared<const RenderMesh>(load_render_mesh(surface_path, set, &of_surface));
        report_warnings(of_surface, progress);
        warnings.insert(warnings.end(), of_surface.begin(), of_surface.end());
        KeepingProgress keeping(progress);
        baked = bake(set, options, keeping);
        miss = find_miss(baked.report, options, has_tolerance);
        if (miss && miss->is_asked && !is_best_effort) throw to_failure(*miss);
        if (miss && !miss->is_asked) warn_of(*miss, keeping);
        add_warnings(keeping.kept(), baked.report, warnings);
    });
    const nb::bytes bytes(reinterpret_cast<const char*>(baked.bytes.data()), baked.bytes.size());
    nb::object missed = nb::none();
    if (miss && miss->is_asked) missed = nb::make_tuple(miss->what, miss->hint);
    return nb::make_tuple(bytes, write_report(baked.report, {}, warnings), missed);
}

// By the numbers of the files.
Positions in_input_order(const PoseSet& poses, const Positions& positions)
{
    if (poses.render_mesh) return render_mesh_positions(*poses.render_mesh, positions);
    if (poses.source_vertices.empty()) return positions;
    Positions out(positions.rows(), 3);
    for (std::size_t v = 0; v < poses.source_vertices.size(); ++v)
        out.row(poses.source_vertices[v]) = positions.row(Eigen::Index(v));
    return out;
}

// What is wrong with an average, or a sum of layers.
void check_average(const FamilyPoint& point, const Weights& weights, const PoseSet& poses, const EnergyOptions& options,
                   const std::string& row, Progress& progress)
{
    if (options.blend == Blend::layers)
        require_layered_shape(point.average, weights, poses.names, row);
    else
        require_convergence(point.average, NewtonOptions(), row);
    warn_of_jumps(point, poses, *options.material, row, progress);
}

// As many averages as rows of weights, each from the mean: none depends on the others.
std::vector<double> averages(const PoseSet& poses, const std::vector<Weights>& wanted, EnergyOptions options,
                             Progress& progress)
{
    const NormalizedPoses set = normalize_poses(poses, options, progress);
    options.material = material_of(options, poses.is_solid());
    const ElasticModel model = make_model(set, options, &progress);
    SolverPool pool(*model.energy, set, options.solver);
    AverageFamily family(pool, exact_newton(set), &progress, {}, model.coarse.get());
    family.mean();
    std::vector<FamilyPoint> points(wanted.size());
    if (wanted.size() == 1) {
        points[0] = family.at_or_near_pose(wanted[0], 0, &progress);
    } else {
        SharedProgress shared(&progress);
        shared.describe("averages", 0, "");
        for_each_task(wanted.size(), [&](std::size_t i, std::size_t worker) {
            points[i] = family.at_or_near_pose(wanted[i], worker, &shared);
        });
    }
    std::vector<double> out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string row = wanted.size() > 1 ? "row " + std::to_string(i) + ": " : "";
        check_average(points[i], wanted[i], poses, options, row, progress);
        const Positions shape = in_input_order(poses, to_input_units(set, points[i].average.y));
        out.insert(out.end(), shape.data(), shape.data() + shape.size());
    }
    return out;
}

nb::object average_poses(const SourcePoses& poses, const Array<double, 2>& weights, const nb::dict& given,
                         const Listener& listener)
{
    const EnergyOptions options = energy_options(given);
    const unsigned threads = given.contains("threads") ? nb::cast<unsigned>(given["threads"]) : 0;
    const std::size_t count = weights.shape(0), m = weights.shape(1);
    std::vector<Weights> wanted;
    for (std::size_t row = 0; row < count; ++row) {
        const double* start = weights.data() + row * m;
        const std::vector<double> values(start, start + m);
        wanted.push_back(options.blend == Blend::layers ? layer_weights(values, poses.meshes.size() - 1)
                                                        : normalized_weights(values, poses.meshes.size()));
    }
    std::vector<double> out;
    work_interruptibly(listener, threads, [&](Progress& progress) {
        std::vector<Diagnostic> warnings;
        const PoseSet set = check(poses, options, warnings, progress);
        if (!wanted.empty()) out = averages(set, wanted, options, progress);
    });
    return to_numpy(std::move(out), { count, std::size_t(poses.meshes[0].positions.rows()), 3 });
}

nb::object positions_of(const SourcePoses& poses)
{
    std::vector<double> out;
    for (const MeshFile& mesh : poses.meshes)
        out.insert(out.end(), mesh.positions.data(), mesh.positions.data() + mesh.positions.size());
    return to_numpy(std::move(out), { poses.meshes.size(), std::size_t(poses.meshes[0].positions.rows()), 3 });
}

bool have_one_count(const SourcePoses& poses)
{
    for (const MeshFile& mesh : poses.meshes)
        if (mesh.positions.rows() != poses.meshes[0].positions.rows()) return false;
    return true;
}

nb::object tets_of(const SourcePoses& poses)
{
    std::vector<std::uint32_t> flat;
    for (const Tetrahedron& tet : poses.meshes[0].tets) flat.insert(flat.end(), tet.begin(), tet.end());
    return to_numpy(std::move(flat), { poses.meshes[0].tets.size(), 4 });
}

std::vector<std::string> names_of(const SourcePoses& poses)
{
    std::vector<std::string> names;
    for (const MeshFile& mesh : poses.meshes) names.push_back(pose_name(mesh));
    return names;
}

nb::bytes read_file(const std::string& path)
{
    DiagnosticList diagnostics;
    std::optional<std::string> bytes;
    {
        const Unlocked unlocked;
        bytes = read_bytes(path, diagnostics);
    }
    if (!bytes) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    return nb::bytes(bytes->data(), bytes->size());
}

void write_file(const std::string& path, const nb::bytes& bytes)
{
    const std::string_view view(bytes.c_str(), bytes.size());
    const Unlocked unlocked;
    write_file_atomically(path, view);
}

void bind_poses(nb::module_& m)
{
    nb::class_<SourcePoses>(m, "Poses")
        .def_prop_ro("pose_count", [](const SourcePoses& poses) { return poses.meshes.size(); })
        .def_prop_ro("vertex_count", [](const SourcePoses& poses) { return std::size_t(poses.meshes[0].positions.rows()); })
        .def("positions", &positions_of)
        .def("have_one_count", &have_one_count)
        .def("faces", [](const SourcePoses& poses) { return faces_to_numpy(poses.meshes[0].faces); })
        .def("tets", &tets_of)
        .def("names", &names_of)
        .def("blend", [](const SourcePoses& poses) { return name_of(poses.blend); });
    m.def("poses_of_arrays", &poses_of_arrays, nb::arg("positions"), nb::arg("faces").none(), nb::arg("tets").none(),
          nb::arg("names"), nb::arg("label"));
    m.def(
        "load_poses",
        [](const std::vector<std::string>& paths, const std::optional<std::string>& blend, const nb::object& warn) {
            std::optional<Blend> kind;
            if (blend) kind = *blend == name_of(Blend::layers) ? Blend::layers : Blend::average;
            return load_sources(paths, kind, { nb::none(), warn });
        },
        nb::arg("paths"), nb::arg("blend").none(), nb::arg("warn"));
}

void bind_work(nb::module_& m)
{
    m.def(
        "bake",
        [](const SourcePoses& poses, const nb::dict& options, const SourcePoses* surface, const std::string& surface_path,
           const nb::object& progress, const nb::object& warn) {
            return bake_poses(poses, options, surface, surface_path, { progress, warn });
        },
        nb::arg("poses"), nb::arg("options"), nb::arg("surface").none(), nb::arg("surface_path"), nb::arg("progress").none(),
        nb::arg("warn"));
    m.def(
        "average",
        [](const SourcePoses& poses, const Array<double, 2>& weights, const nb::dict& options, const nb::object& progress,
           const nb::object& warn) {
            return average_poses(poses, weights, options, { progress, warn });
        },
        nb::arg("poses"), nb::arg("weights"), nb::arg("options"), nb::arg("progress").none(), nb::arg("warn"));
}

void bind_energy(nb::module_& m)
{
    nb::class_<EnergyView>(m, "EnergyView")
        .def(
            "__init__",
            [](EnergyView* self, const SourcePoses& poses, const nb::dict& options, const nb::object& progress,
               const nb::object& warn) {
                new (self) EnergyView(poses, options, { progress, warn });
            },
            nb::arg("poses"), nb::arg("options"), nb::arg("progress").none(), nb::arg("warn"))
        .def("value", &EnergyView::value, nb::arg("x"), nb::arg("weights"))
        .def("gradient", &EnergyView::gradient, nb::arg("x"), nb::arg("weights"))
        .def("hessian", &EnergyView::hessian, nb::arg("x"), nb::arg("weights"), nb::arg("projected"))
        .def("poses", &EnergyView::poses)
        .def("masses", &EnergyView::masses)
        .def("vertices", &EnergyView::vertices)
        .def_prop_ro("length", &EnergyView::length)
        .def_prop_ro("vertex_count", &EnergyView::vertex_count)
        .def_prop_ro("weight_count", &EnergyView::weight_count);
}

void bind_asset(nb::module_& m)
{
    nb::class_<AssetView>(m, "AssetView")
        .def(nb::init<const nb::object&, const std::string&, bool>(), nb::arg("data"), nb::arg("name"), nb::arg("verify"))
        .def("solve", &AssetView::solve, nb::arg("weights"), nb::arg("continuous"))
        .def("energy", &AssetView::energy, nb::arg("weights"), nb::arg("q"))
        .def("reconstruct", &AssetView::reconstruct, nb::arg("q"), nb::arg("first"), nb::arg("count"))
        .def("normals", &AssetView::normals, nb::arg("positions"))
        .def("faces", &AssetView::faces)
        .def("triangles", &AssetView::triangles)
        .def("pose_coordinates", &AssetView::pose_coordinates)
        .def("names", &AssetView::names)
        .def("weights", &AssetView::weights)
        .def("certificate",
             [](const AssetView& view) {
                 const std::string text = certificate_of(view.asset());
                 return nb::bytes(text.data(), text.size());
             })
        .def("bytes", &AssetView::bytes)
        .def_prop_ro("size", [](const AssetView& view) { return view.asset().blob_size; })
        .def_prop_ro("is_in_place", &AssetView::is_in_place)
        .def_prop_ro("is_solid", [](const AssetView& view) { return view.asset().source_vertices != nullptr; })
        .def_prop_ro("vertex_count", [](const AssetView& view) { return view.asset().vertex_count; })
        .def_prop_ro("pose_count", [](const AssetView& view) { return view.asset().pose_count; })
        .def_prop_ro("weight_count", [](const AssetView& view) { return view.asset().weight_count; })
        .def_prop_ro("has_layers", [](const AssetView& view) { return view.asset().has_layers != 0; })
        .def_prop_ro("dimension", [](const AssetView& view) { return view.asset().dimension; });
}

} // namespace

NB_MODULE(_core, m)
{
    nb::set_leak_warnings(false); // daemon threads end with what they hold
    nb::register_exception_translator(translate);
    m.def("version", [] { return std::string(version); });
    m.def("has_cholmod", &has_cholmod);
    m.def("read_file", &read_file, nb::arg("path"));
    m.def("write_file", &write_file, nb::arg("path"), nb::arg("data"));
    bind_poses(m);
    bind_work(m);
    bind_energy(m);
    bind_asset(m);
    Py_AtExit(&end_work);
}

} // namespace pliant
