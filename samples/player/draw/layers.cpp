#include "draw/layers.h"

#include <algorithm>

namespace pliant::player {
namespace {

glm::vec3 mean_of(const std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& which)
{
    glm::dvec3 sum(0.0);
    for (std::uint32_t v : which) sum += glm::dvec3(vertices[v].position);
    return glm::vec3(sum / static_cast<double>(which.size()));
}

} // namespace

std::vector<Layer> layers_of(const glm::mat4& view, const std::vector<Actor>& actors,
                             const std::vector<std::vector<std::uint32_t>>& blended)
{
    std::vector<Layer> layers;
    for (std::size_t b = 0; b < blended.size(); ++b) {
        for (std::size_t i = 0; i < actors.size(); ++i) {
            const Actor& actor = actors[i];
            const glm::vec3 mean = actor.built ? actor.built->blended_centres[b] : mean_of(*actor.vertices, blended[b]);
            const glm::vec4 seen = view * model_of(actor) * glm::vec4(mean, 1.0f);
            layers.push_back({ -seen.z, i, b });
        }
    }
    std::stable_sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) { return a.depth > b.depth; });
    return layers;
}

} // namespace pliant::player
