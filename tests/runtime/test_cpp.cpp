// The C++ header on the small assets: the bits of the C functions, and errors for what those refuse.
#include "pliant.hpp"

#include <doctest/doctest.h>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

namespace {

std::vector<unsigned char> bytes_of(const std::string& name)
{
    std::ifstream file(std::string(PLIANT_TINY_ASSETS) + "/" + name + ".pliant", std::ios::binary);
    return { std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
}

pliant_result error_of(const std::vector<unsigned char>& bytes)
{
    try {
        const pliant::Asset asset(bytes);
    } catch (const pliant::Error& error) {
        CHECK(std::string(error.what()) == pliant_result_text(error.result()));
        return error.result();
    }
    return PLIANT_OK;
}

template <class Call> pliant_result result_of(const Call& call)
{
    try {
        call();
    } catch (const pliant::Error& error) {
        return error.result();
    }
    return PLIANT_OK;
}

} // namespace

TEST_CASE("blends and normals have the bits of the C functions, also after the asset was moved")
{
    for (const char* name : { "strip_neo", "strip_factored", "beam_mixed", "layers_mixed" }) {
        CAPTURE(name);
        const std::vector<unsigned char> bytes = bytes_of(name);
        pliant::Asset first(bytes);
        pliant::Solver solver(first);
        const pliant::Normals normals(first);
        const pliant::Asset asset(std::move(first));
        std::vector<float> weights(asset->weight_count, 0.25f), positions(3 * asset->vertex_count),
            expected = positions, of_surface(3 * asset->boundary_vertex_count), q(asset->dimension);
        const pliant_solve_info info = solver.solve(weights);
        pliant::reconstruct(asset, solver.coordinates(), positions);
        normals.compute(positions, of_surface);

        const pliant_solver_desc desc = pliant_solver_desc_default();
        std::vector<unsigned char> memory(pliant_solver_memory(asset.get(), &desc));
        pliant_solver* plain = nullptr;
        REQUIRE(pliant_solver_init(&plain, asset.get(), &desc, memory.data(), memory.size()) == PLIANT_OK);
        pliant_solve_info plain_info;
        REQUIRE(pliant_solve(plain, weights.data(), q.data(), &plain_info) == PLIANT_OK);
        pliant_reconstruct(asset.get(), q.data(), 0, asset->vertex_count, expected.data(), 12);
        CHECK(positions == expected);
        CHECK(info.evaluations == plain_info.evaluations);
        std::vector<float> plain_normals(of_surface.size());
        pliant_normals_compute(normals.get(), expected.data(), 12, 0, asset->boundary_vertex_count, plain_normals.data(),
                               12);
        CHECK(of_surface == plain_normals);

        solver.reset();
        solver.solve(weights);
        CHECK(std::vector<float>(solver.coordinates().begin(), solver.coordinates().end()) == q);
    }
}

TEST_CASE("names, ranges, poses and fields")
{
    const pliant::Asset asset(bytes_of("layers_mixed"));
    CHECK(asset->has_layers == 1);
    for (std::uint32_t i = 0; i < asset->weight_count; ++i) CHECK(asset.find_weight(asset.weight(i).name) == i);
    CHECK(asset.find_weight("no such weight") == asset->weight_count);
    CHECK(result_of([&] { asset.weight(asset->weight_count); }) == PLIANT_ERROR_ARGUMENT);
    CHECK(result_of([&] { asset.pose_coordinates(asset->pose_count); }) == PLIANT_ERROR_ARGUMENT);
    CHECK(asset.pose_coordinates(0).size() == pliant_asset_get_dimension(asset.get()));
    CHECK(asset.triangles().size() == 3 * pliant_asset_get_triangle_count(asset.get()));
    CHECK(asset.triangles().data() == pliant_asset_get_triangles(asset.get()));
    CHECK(pliant_asset_get_vertex_count(asset.get()) == asset->vertex_count);
    CHECK(pliant_asset_get_boundary_vertex_count(asset.get()) == asset->boundary_vertex_count);
    CHECK(pliant_asset_get_pose_count(asset.get()) == asset->weight_count + 1);
    CHECK(pliant_asset_get_weight_count(asset.get()) == asset->weight_count);
    CHECK(pliant_asset_get_has_layers(asset.get()) == 1);
    CHECK(pliant_asset_get_origin(asset.get()) == asset->origin);
    CHECK(pliant_asset_get_source_vertices(asset.get()) == nullptr);
    CHECK(pliant_asset_get_smoothing_groups(asset.get()) == asset->smoothing_groups);
    CHECK(pliant_asset_get_vertex_count(nullptr) == 0);
    CHECK(pliant_asset_get_triangles(nullptr) == nullptr);
    CHECK(pliant_asset_size() == sizeof(pliant_asset));
    CHECK(pliant_normals_size() == sizeof(pliant_normals));
    pliant_solver_desc desc;
    pliant_solver_desc_init(&desc);
    CHECK(desc.struct_size == sizeof desc);
    pliant_solver_desc_init(nullptr);
}

TEST_CASE("errors are exceptions, and what was there before stays")
{
    const pliant::Asset asset(bytes_of("strip_neo"));
    pliant::Solver solver(asset);
    std::vector<float> weights(asset->weight_count, 1.0f), positions(3 * asset->vertex_count);
    solver.solve(weights);
    const std::vector<float> before(solver.coordinates().begin(), solver.coordinates().end());
    weights[0] = -1;
    CHECK(result_of([&] { solver.solve(weights); }) == PLIANT_ERROR_WEIGHT_NEGATIVE);
    weights.push_back(1);
    CHECK(result_of([&] { solver.solve(weights); }) == PLIANT_ERROR_ARGUMENT);
    CHECK(result_of([&] { solver.solve({ 1.0f }); }) == PLIANT_ERROR_ARGUMENT);
    CHECK(std::vector<float>(solver.coordinates().begin(), solver.coordinates().end()) == before);
    positions.pop_back();
    CHECK(result_of([&] { pliant::reconstruct(asset, solver.coordinates(), positions); }) == PLIANT_ERROR_ARGUMENT);
    CHECK(result_of([&] { pliant::Normals(asset).compute(positions, positions); }) == PLIANT_ERROR_ARGUMENT);
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.tolerance = -1;
    CHECK(result_of([&] { pliant::Solver bad(asset, desc); }) == PLIANT_ERROR_ARGUMENT);

    std::vector<unsigned char> bytes = bytes_of("strip_neo");
    CHECK(error_of(bytes) == PLIANT_OK);
    bytes.back() ^= 1;
    CHECK(error_of(bytes) == PLIANT_ERROR_CHECKSUM);
    CHECK(error_of({}) == PLIANT_ERROR_TRUNCATED);
    CHECK(error_of(std::vector<unsigned char>(4096)) == PLIANT_ERROR_NOT_PLIANT);
    const std::vector<unsigned char> whole = bytes_of("strip_neo");
    CHECK(result_of([&] { pliant::Asset::in_place({ whole.data() + 1, whole.size() - 1 }); }) == PLIANT_ERROR_ALIGNMENT);
}
