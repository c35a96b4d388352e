#include "output/asset/element_batches.h"

#include "pliant_format.h"

#include <algorithm>
#include <map>

namespace pliant {

namespace {

constexpr std::size_t lane_count = 16;

// A layer that changes the rest state of an element by less leaves it as it is.
constexpr double least_change = 1e-6;

// What the element looks at: the differences (three rows each), or combinations of them.
Eigen::MatrixXd combine(const Eigen::MatrixXd& differences, const RuntimeElement& element)
{
    const Eigen::MatrixXd& c = element.combination;
    if (c.size() == 0) return differences;
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * c.cols(), differences.cols());
    for (Eigen::Index j = 0; j < c.cols(); ++j)
        for (Eigen::Index i = 0; i < c.rows(); ++i) out.middleRows<3>(3 * j) += c(i, j) * differences.middleRows<3>(3 * i);
    // The deformation gradient relative to z = 0 is the identity there; its rounding would be one of the format.
    if (element.kind == PLIANT_ELEMENT_TET_STVK || element.kind == PLIANT_ELEMENT_TET_MOONEY_RIVLIN)
        out.col(0) = Eigen::Map<const Eigen::VectorXd>(Eigen::Matrix3d::Identity().eval().data(), 9);
    return out;
}

// The same energy as an open cell of at least as many spokes. A closed ring needs its first spoke once more at the end; what
// is added has no stiffness of its own.
BakedElement open_cell(const BakedElement& cell, std::uint32_t valence)
{
    const RuntimeElement& old = cell.element;
    const Eigen::Index spokes = old.valence, wanted = valence, rims = old.is_closed ? spokes : spokes - 1;
    BakedElement out = cell;
    out.element.valence = valence;
    out.element.is_closed = false;
    out.rows.resize(3 * wanted, cell.rows.cols());
    for (Eigen::Index i = 0; i < wanted; ++i)
        out.rows.middleRows<3>(3 * i) = cell.rows.middleRows<3>(3 * (i < spokes ? i : 0));
    // Numbers for every spoke, then for every rim; of averages one number more.
    const bool has_layers = old.kind == PLIANT_ELEMENT_LAYERED_ARAP_CELL;
    const Eigen::Index each = has_layers ? 3 : 4, more = has_layers ? 0 : 1;
    const Eigen::MatrixXd& from = old.pose_numbers;
    Eigen::MatrixXd& to = out.element.pose_numbers;
    to.setZero(from.rows(), each * (2 * wanted - 1) + more);
    to.leftCols(each * spokes) = from.leftCols(each * spokes);
    to.middleCols(each * wanted, each * rims) = from.middleCols(each * spokes, each * rims);
    to.rightCols(more) = from.rightCols(more);
    if (!has_layers) return out;
    out.element.fixed.assign(std::size_t(2 * wanted - 1), 0.0);
    std::copy_n(old.fixed.begin(), spokes, out.element.fixed.begin());
    std::copy_n(old.fixed.begin() + spokes, rims, out.element.fixed.begin() + wanted);
    return out;
}

std::uint32_t open_valence(const BakedElement& cell) { return cell.element.valence + (cell.element.is_closed ? 1 : 0); }

// Whether a layer changes the element: beyond rounding, of angles and logarithms of stretches as they are, of others
// relative to their own size.
bool is_changed(const RuntimeElement& element, Eigen::Index layer)
{
    const bool is_absolute
        = element.kind == PLIANT_ELEMENT_LAYERED_HINGE || element.kind == PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN;
    const double unit = is_absolute ? 1 : element.pose_numbers.row(0).cwiseAbs().maxCoeff();
    return element.pose_numbers.row(1 + layer).cwiseAbs().maxCoeff() > least_change * unit;
}

// Elements that the same layers change lie next to each other, so that few groups of lanes need any one layer.
void sort_by_layers(ElementBatch& batch)
{
    std::vector<std::pair<std::vector<bool>, std::size_t>> order;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        std::vector<bool> changed;
        for (Eigen::Index layer = 0; layer + 1 < batch[i].element.pose_numbers.rows(); ++layer)
            changed.push_back(is_changed(batch[i].element, layer));
        order.emplace_back(std::move(changed), i);
    }
    std::sort(order.begin(), order.end());
    ElementBatch sorted;
    for (const auto& place : order) sorted.push_back(std::move(batch[place.second]));
    batch = std::move(sorted);
}

// Sorted by valence, each block of lanes as wide as its largest cell.
void widen_cells(ElementBatch& cells)
{
    std::stable_sort(cells.begin(), cells.end(),
                     [](const BakedElement& a, const BakedElement& b) { return open_valence(a) < open_valence(b); });
    for (std::size_t end = cells.size(); end > 0;) {
        const std::size_t begin = (end - 1) / lane_count * lane_count;
        const std::uint32_t valence = open_valence(cells[end - 1]);
        for (; end > begin; --end) cells[end - 1] = open_cell(cells[end - 1], valence);
    }
}

} // namespace

BakedElement bake_element(const AssetModel& asset, std::size_t i)
{
    const BlendModel& model = asset.model;
    const SurrogateEnergy& surrogate = *model.surrogate;
    const std::size_t id = surrogate.elements()[i];
    BakedElement baked;
    baked.element = surrogate.energy().runtime_element(id, asset.surrogate_reference);
    baked.element.scale(surrogate.weights()[Eigen::Index(i)]);
    std::size_t count = 0;
    const std::uint32_t* vertices = surrogate.energy().element_vertices(id, count);
    Eigen::MatrixXd local(surrogate.rows(i).rows(), 1 + model.whitening.cols());
    local.col(0) = surrogate.rest_rows(i) + surrogate.rows(i) * model.mean;
    local.rightCols(model.whitening.cols()) = surrogate.rows(i) * model.whitening;
    const auto place
        = [&](std::uint32_t vertex) { return 3 * Eigen::Index(std::find(vertices, vertices + count, vertex) - vertices); };
    const auto& differences = baked.element.differences;
    Eigen::MatrixXd rows(3 * Eigen::Index(differences.size()), local.cols());
    for (std::size_t r = 0; r < differences.size(); ++r)
        rows.middleRows<3>(3 * Eigen::Index(r))
            = local.middleRows<3>(place(differences[r][1])) - local.middleRows<3>(place(differences[r][0]));
    baked.rows = combine(rows, baked.element);
    return baked;
}

namespace {

// Of layers those at v = 0 and what each of them adds.
Eigen::MatrixXd tie_numbers(const Eigen::Vector3d& start, const Eigen::MatrixXd& wanted, double stiffness, Blend blend)
{
    const bool has_layers = blend == Blend::layers;
    Eigen::MatrixXd numbers = Eigen::MatrixXd::Zero(wanted.cols() + has_layers, 4);
    numbers.bottomRightCorner(wanted.cols(), 3) = -2 * stiffness * wanted.transpose();
    const Eigen::Index begin_count = has_layers ? 1 : numbers.rows();
    numbers.topLeftCorner(begin_count, 1).setConstant(stiffness);
    numbers.topRightCorner(begin_count, 3).rowwise() += 2 * stiffness * start.transpose();
    return numbers;
}

} // namespace

std::vector<BakedElement> bake_gauge(const AssetModel& asset)
{
    const BlendModel& model = asset.model;
    const Gauge& gauge = model.surrogate->gauge();
    std::vector<BakedElement> out;
    for (Eigen::Index first = 0; first < gauge.along.rows() && gauge.stiffness > 0; first += 3) {
        const Eigen::MatrixXd along = gauge.along.middleRows<3>(first), wanted = gauge.wanted.middleRows<3>(first);
        const Eigen::Vector3d start = along * model.mean;
        BakedElement held;
        held.element.kind = PLIANT_ELEMENT_TIE;
        held.rows.setZero(9, 1 + model.whitening.cols());
        held.rows.topRows<3>() << start, along * model.whitening;
        held.rows(3, 0) = held.rows(7, 0) = 1; // e1 and e2
        held.element.pose_numbers = tie_numbers(start, wanted, gauge.stiffness, model.surrogate->energy().blend());
        out.push_back(std::move(held));
    }
    return out;
}

std::vector<LayerChange> changes_of(const ElementBatch& batch)
{
    std::vector<LayerChange> out;
    for (Eigen::Index layer = 0; layer + 1 < batch[0].element.pose_numbers.rows(); ++layer)
        for (std::size_t first = 0; first < batch.size(); first += lane_count) {
            const auto begin = batch.begin() + std::ptrdiff_t(first),
                       end = batch.begin() + std::ptrdiff_t(std::min(batch.size(), first + lane_count));
            if (std::any_of(begin, end, [&](const BakedElement& element) { return is_changed(element.element, layer); }))
                out.push_back({ std::uint32_t(layer), std::uint32_t(first / lane_count) });
        }
    return out;
}

std::vector<ElementBatch> group_elements(std::vector<BakedElement> elements, Blend blend)
{
    std::map<std::uint32_t, ElementBatch> kinds;
    for (BakedElement& element : elements) kinds[element.element.kind].push_back(std::move(element));
    if (blend == Blend::layers)
        for (auto& [kind, batch] : kinds) sort_by_layers(batch);
    for (const std::uint32_t kind : { PLIANT_ELEMENT_ARAP_CELL, PLIANT_ELEMENT_LAYERED_ARAP_CELL })
        if (kinds.count(kind)) widen_cells(kinds[kind]);
    std::vector<ElementBatch> batches;
    for (auto& [kind, batch] : kinds)
        for (BakedElement& element : batch) {
            if (batches.empty() || batches.back()[0].element.kind != kind
                || batches.back()[0].element.valence != element.element.valence)
                batches.emplace_back();
            batches.back().push_back(std::move(element));
        }
    return batches;
}

} // namespace pliant
