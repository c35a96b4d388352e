#include "asset_view.h"

#include "unlocked.h"

#include "base/common/diagnostics.h"
#include "output/asset/runtime_blender.h"
#include "pliant_format.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace pliant {
namespace {

bool is_aligned(const void* address)
{
    return reinterpret_cast<std::uintptr_t>(address) % PLIANT_FORMAT_BLOB_ALIGNMENT == 0;
}

bool is_map(const nb::object& object) { return object.type().is(nb::module_::import_("mmap").attr("mmap")); }

// Whether nobody can change the bytes: read-only views of writable memory look the same as constant ones, so kinds are
// named.
bool is_constant(const nb::object& object, const Py_buffer& buffer)
{
    if (PyBytes_CheckExact(object.ptr())) return true;
    return is_map(object) && buffer.readonly;
}

// For blobs that were copied: memory at a multiple of 16.
std::uint8_t* aligned_start(std::vector<std::uint64_t>& words)
{
    return reinterpret_cast<std::uint8_t*>(words.data()) + (is_aligned(words.data()) ? 0 : 8);
}

} // namespace

// A solver in its memory.
struct AssetView::Solver {
    explicit Solver(const pliant_asset& asset)
    {
        const pliant_solver_desc desc = pliant_solver_desc_default();
        const std::size_t size = pliant_solver_memory(&asset, &desc);
        memory.resize(size / 8 + 1);
        if (size == 0 || pliant_solver_init(&solver, &asset, &desc, memory.data(), size) != PLIANT_OK)
            throw Failure(ExitCode::failed, error_at(4504, "", "the solver settings are refused by the runtime"));
    }
    std::vector<std::uint64_t> memory;
    pliant_solver* solver = nullptr;
};

// A solver for the time of a call: an idle one, as good as new, or a new one. Made and ended with the interpreter locked.
class AssetView::Loan {
public:
    explicit Loan(AssetView& view)
        : view_(view)
    {
        if (view.idle_.empty()) {
            solver_ = std::make_unique<Solver>(view.asset_);
        } else {
            solver_ = std::move(view.idle_.back());
            view.idle_.pop_back();
        }
        reset();
    }
    ~Loan() { view_.idle_.push_back(std::move(solver_)); }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

    void reset() { pliant_solver_reset(solver_->solver); }
    pliant_result solve(const float* weights, float* q) { return pliant_solve(solver_->solver, weights, q, nullptr); }
    pliant_solver* get() { return solver_->solver; }

private:
    AssetView& view_;
    std::unique_ptr<Solver> solver_;
};

AssetView::AssetView(const nb::object& bytes, const std::string& name, bool verify)
{
    if (PyObject_GetBuffer(bytes.ptr(), &buffer_, PyBUF_SIMPLE) != 0) throw nb::python_error();
    const std::size_t size = static_cast<std::size_t>(buffer_.len);
    const void* start = buffer_.buf;
    if (!is_constant(bytes, buffer_) || !is_aligned(start)) {
        copy_.resize(size / 8 + 4);
        if (size) std::memcpy(aligned_start(copy_), start, size);
        start = aligned_start(copy_);
    }
    pliant_result result;
    {
        const Unlocked unlocked;
        result = pliant_asset_open(&asset_, start, size, verify ? PLIANT_OPEN_VERIFY_CHECKSUMS : PLIANT_OPEN_DEFAULT);
    }
    if (result == PLIANT_OK) return;
    PyBuffer_Release(&buffer_); // no destructor runs
    throw open_failure(result, name);
}

AssetView::~AssetView() { PyBuffer_Release(&buffer_); }

nb::bytes AssetView::bytes() const
{
    if (is_in_place() && PyBytes_CheckExact(buffer_.obj)) return nb::borrow<nb::bytes>(buffer_.obj);
    return nb::bytes(reinterpret_cast<const char*>(asset_.blob), static_cast<std::size_t>(asset_.blob_size));
}

nb::object AssetView::solve(const Array<float, 2>& weights, bool continuous)
{
    const std::size_t count = weights.shape(0), m = weights.shape(1), d = asset_.dimension;
    if (m != asset_.weight_count) throw nb::value_error("weights: one per pose or layer are needed");
    std::vector<float> q(count * d);
    std::size_t row = 0;
    pliant_result result = PLIANT_OK;
    {
        Loan loan(*this);
        const Unlocked unlocked;
        for (; row < count && result == PLIANT_OK; ++row) {
            if (!continuous) loan.reset();
            result = loan.solve(weights.data() + row * m, q.data() + row * d);
        }
    }
    if (result != PLIANT_OK) refuse_weights(result, weights, row - 1);
    return to_numpy(std::move(q), { count, d });
}

void AssetView::refuse_weights(pliant_result result, const Array<float, 2>& weights, std::size_t row) const
{
    const float* bad = weights.data() + row * weights.shape(1);
    throw Failure(ExitCode::usage,
                  error_at(1204, "",
                           fmt::format("weights {}{}: {}", weights.shape(0) > 1 ? fmt::format("of row {}: ", row) : "",
                                       fmt::join(bad, bad + weights.shape(1), ","), pliant_result_text(result)),
                           asset_.has_layers ? "weights are finite" : "weights are finite, not negative, and not all zero"));
}

const SurrogateCoordinates& AssetView::surrogate_coordinates()
{
    if (!surrogate_coordinates_) surrogate_coordinates_ = std::make_unique<SurrogateCoordinates>(asset_);
    return *surrogate_coordinates_;
}

nb::object AssetView::energy(const Array<float, 2>& weights, const Array<double, 2>& q)
{
    const std::size_t count = weights.shape(0), d = asset_.dimension;
    if (weights.shape(1) != asset_.weight_count || q.shape(0) != count || q.shape(1) != d)
        throw nb::value_error("weights, q: as many rows of both, of the widths of the asset");
    std::vector<double> values(count), gradients(count * d);
    std::size_t row = 0;
    pliant_result result = PLIANT_OK;
    {
        const SurrogateCoordinates& coordinates = surrogate_coordinates();
        Loan loan(*this);
        const Unlocked unlocked;
        std::vector<float> answer(d);
        Eigen::VectorXd gradient;
        for (; row < count && result == PLIANT_OK; ++row) {
            loan.reset();
            result = loan.solve(weights.data() + row * weights.shape(1), answer.data()); // combines for the weights
            if (result != PLIANT_OK) continue;
            const bool is_finite
                = evaluate_surrogate(loan.get(), coordinates.to_z(q.data() + row * d), values[row], gradient);
            if (!is_finite) values[row] = std::numeric_limits<double>::infinity();
            gradient = is_finite ? coordinates.gradient_by_q(gradient)
                                 : Eigen::VectorXd::Constant(Eigen::Index(d), std::numeric_limits<double>::quiet_NaN());
            std::copy(gradient.begin(), gradient.end(), gradients.begin() + std::ptrdiff_t(row * d));
        }
    }
    if (result != PLIANT_OK) refuse_weights(result, weights, row - 1);
    return nb::make_tuple(to_numpy(std::move(values), { count }), to_numpy(std::move(gradients), { count, d }));
}

// Of a solid all vertices are made, as the runtime numbers them otherwise.
void AssetView::reconstruct_one(const float* q, std::size_t first, std::size_t count, float* out,
                                std::vector<float>& buffer) const
{
    const auto stride = 3 * sizeof(float);
    if (!asset_.source_vertices) {
        pliant_reconstruct(&asset_, q, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), out, stride);
        return;
    }
    buffer.resize(3 * std::size_t(asset_.vertex_count));
    pliant_reconstruct(&asset_, q, 0, asset_.vertex_count, buffer.data(), stride);
    for (std::uint32_t v = 0; v < asset_.vertex_count; ++v) {
        const std::size_t place = asset_.source_vertices[v];
        if (place >= first && place - first < count)
            std::memcpy(out + 3 * (place - first), &buffer[3 * std::size_t(v)], stride);
    }
}

nb::object AssetView::reconstruct(const Array<float, 2>& q, std::size_t first, std::size_t count) const
{
    const std::size_t rows = q.shape(0), d = asset_.dimension;
    if (q.shape(1) != d || first > asset_.vertex_count || count > asset_.vertex_count - first)
        throw nb::value_error("q, first, count: outside the asset");
    std::vector<float> out(rows * count * 3);
    {
        const Unlocked unlocked;
        std::vector<float> buffer;
        for (std::size_t row = 0; row < rows && count; ++row)
            reconstruct_one(q.data() + row * d, first, count, out.data() + row * count * 3, buffer);
    }
    return to_numpy(std::move(out), { rows, count, 3 });
}

void AssetView::prepare_normals()
{
    if (!normals_memory_.empty()) return;
    const std::size_t size = pliant_normals_memory(&asset_);
    std::vector<std::uint64_t> memory(size / 8 + 1);
    if (pliant_normals_init(&normals_, &asset_, memory.data(), memory.size() * 8) != PLIANT_OK)
        throw Failure(ExitCode::failed, error_at(4504, "", "the runtime makes no normals of this asset"));
    normals_memory_ = std::move(memory);
}

void AssetView::normals_of_one(const float* positions, float* out, std::vector<float>& buffer) const
{
    const std::size_t boundary = normals_.vertex_count;
    const auto stride = 3 * sizeof(float);
    if (!asset_.source_vertices) {
        pliant_normals_compute(&normals_, positions, stride, 0, normals_.vertex_count, out, stride);
        return;
    }
    buffer.resize(6 * boundary);
    for (std::uint32_t v = 0; v < boundary; ++v)
        std::memcpy(&buffer[3 * std::size_t(v)], positions + 3 * std::size_t(asset_.source_vertices[v]), stride);
    float* made = buffer.data() + 3 * boundary;
    pliant_normals_compute(&normals_, buffer.data(), stride, 0, normals_.vertex_count, made, stride);
    for (std::uint32_t v = 0; v < asset_.vertex_count; ++v) {
        const float inside[3] = { 0, 0, 1 }; // what the runtime gives where there is no triangle
        std::memcpy(out + 3 * std::size_t(asset_.source_vertices[v]), v < boundary ? made + 3 * std::size_t(v) : inside,
                    stride);
    }
}

nb::object AssetView::normals(const Array<float, 3>& positions)
{
    const std::size_t rows = positions.shape(0), n = positions.shape(1);
    if (n != asset_.vertex_count || positions.shape(2) != 3) throw nb::value_error("positions: not those of this asset");
    std::vector<float> out(rows * n * 3);
    {
        prepare_normals();
        const Unlocked unlocked;
        std::vector<float> buffer;
        for (std::size_t row = 0; row < rows; ++row)
            normals_of_one(positions.data() + row * n * 3, out.data() + row * n * 3, buffer);
    }
    return to_numpy(std::move(out), { rows, n, 3 });
}

nb::object AssetView::faces() const
{
    Polygons faces = faces_of(asset_);
    for (std::uint32_t& vertex : faces.indices) vertex = input_number(vertex);
    return faces_to_numpy(faces);
}

nb::object AssetView::triangles() const
{
    std::vector<std::uint32_t> corners(asset_.triangles, asset_.triangles + 3 * std::size_t(asset_.triangle_count));
    for (std::uint32_t& vertex : corners) vertex = input_number(vertex);
    return to_numpy(std::move(corners), { asset_.triangle_count, 3 });
}

nb::object AssetView::pose_coordinates() const
{
    std::vector<float> out;
    for (std::uint32_t k = 0; k < asset_.pose_count; ++k) {
        const float* q = pliant_asset_pose_coordinates(&asset_, k);
        out.insert(out.end(), q, q + asset_.dimension);
    }
    return to_numpy(std::move(out), { asset_.pose_count, asset_.dimension });
}

nb::list AssetView::names() const
{
    nb::list names;
    for (std::uint32_t k = 0; k < asset_.pose_count; ++k) {
        const char* name = pliant_asset_pose_name(&asset_, k);
        names.append(nb::bytes(name ? name : ""));
    }
    return names;
}

nb::list AssetView::weights() const
{
    nb::list all;
    pliant_weight weight;
    for (std::uint32_t i = 0; pliant_asset_weight(&asset_, i, &weight) == PLIANT_OK; ++i)
        all.append(nb::make_tuple(nb::bytes(weight.name), weight.low, weight.high, weight.initial));
    return all;
}

} // namespace pliant
