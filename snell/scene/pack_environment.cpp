#include "snell/core/parallel.h"
#include "snell/kernel/environment.h"
#include "snell/scene/pack_parts.h"

#include <algorithm>
#include <cmath>

namespace snell {

// More cells than this would follow the picture no better than its noise deserves.
static constexpr uint max_columns = 1024, max_rows = 512;

// Looked up as rays do, at the centres of the texels in the cell and at its corners: what filtering brings over from a
// bright neighbour counts as well.
static EnvironmentCells look_at(const SceneView& view, const Texture& texture)
{
    EnvironmentCells cells;
    cells.image = view.environment.texture;
    cells.mapping = view.environment.mapping;
    const uint columns = cells.columns = std::min(texture.width, max_columns);
    const uint rows = cells.rows = std::min(texture.height, max_rows);
    cells.means.resize(std::size_t{columns} * rows);
    const uint steps_x = std::max(2u, texture.width / columns), steps_y = std::max(2u, texture.height / rows);
    parallel_for(rows, [&](std::size_t y) {
        for (uint x = 0; x < columns; ++x) {
            glm::dvec3 sum(0.0);
            for (uint j = 0; j <= steps_y; ++j)
                for (uint i = 0; i <= steps_x; ++i) {
                    const vec2 p((static_cast<float>(x) + static_cast<float>(i) / static_cast<float>(steps_x)) /
                                     static_cast<float>(columns),
                                 (static_cast<float>(y) + static_cast<float>(j) / static_cast<float>(steps_y)) /
                                     static_cast<float>(rows));
                    TextureSlot slot = {};
                    slot.texture = view.environment.texture;
                    slot.wrap_u = view.environment.mapping == environment_octahedral ? wrap_clamp : wrap_repeat;
                    slot.wrap_v = wrap_clamp;
                    sum += glm::dvec3(filter_texture(view, slot, vec2(p.x, 1.0f - p.y)));
                }
            cells.means[y * columns + x] = vec3(sum / ((steps_x + 1.0) * (steps_y + 1.0)));
        }
    });
    return cells;
}

// Expected brightness of each cell times its solid angle.
static std::vector<double> cell_weights(const Environment& environment, const EnvironmentCells& cells)
{
    std::vector<double> weights(cells.means.size());
    parallel_for(cells.rows, [&](std::size_t y) {
        const vec2 middle(0.5f, (static_cast<float>(y) + 0.5f) / static_cast<float>(cells.rows));
        const double solid_angle = static_cast<double>(environment_solid_angle(environment, middle));
        for (std::size_t i = y * cells.columns; i < (y + 1) * cells.columns; ++i) {
            const float brightness = luminance(cells.means[i] * environment.radiance);
            weights[i] = solid_angle * static_cast<double>(std::max(brightness, 0.0f));
        }
    });
    return weights;
}

// Appends 0, the partial sums over the total, and 1. Without any weight: a uniform distribution.
static void append_cdf(std::vector<float>& cdf, const double* weights, std::size_t count)
{
    double total = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) total += weights[i];
    cdf.push_back(0.0f);
    for (std::size_t i = 0; i < count; ++i) {
        sum += weights[i];
        const double part = total > 0.0 ? sum / total : static_cast<double>(i + 1) / static_cast<double>(count);
        cdf.push_back(i + 1 == count ? 1.0f : static_cast<float>(part));
    }
}

void choose_environment(PackedScene& packed)
{
    if (packed.environment.columns > 0u) packed.environment.select_pdf = packed.lights.empty() ? 1.0f : 0.5f;
}

void pack_environment(const Scene& scene, PackedScene& packed, EnvironmentCells& kept)
{
    packed.environment_cdf.clear();
    const EnvironmentDesc& desc = scene.environment;
    Environment& e = packed.environment;
    e = {};
    e.radiance = desc.radiance;
    e.texture = desc.image.value;
    e.mapping = desc.mapping;
    e.is_visible = desc.visible ? 1u : 0u;
    const Transform map = inverse(desc.to_world).value();
    e.row_x = vec3(map.x), e.row_y = vec3(map.y), e.row_z = vec3(map.z);
    if (e.texture == none || is_black(e.radiance)) return;

    if (kept.image != e.texture || kept.mapping != e.mapping) kept = look_at(packed.view(), packed.textures[e.texture]);
    const uint columns = kept.columns, rows = kept.rows;
    const std::vector<double> weights = cell_weights(e, kept);
    std::vector<double> row_weights(rows);
    for (uint y = 0; y < rows; ++y)
        for (uint x = 0; x < columns; ++x) row_weights[y] += weights[std::size_t{y} * columns + x];
    if (*std::max_element(row_weights.begin(), row_weights.end()) <= 0.0) {
        e.radiance = vec3(0.0f); // a black picture
        return;
    }
    append_cdf(packed.environment_cdf, row_weights.data(), rows);
    for (uint y = 0; y < rows; ++y)
        append_cdf(packed.environment_cdf, weights.data() + std::size_t{y} * columns, columns);
    e.columns = columns;
    e.rows = rows;
    choose_environment(packed);
}

} // namespace snell
