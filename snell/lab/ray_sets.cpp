#include "snell/lab/ray_sets.h"

#include "snell/core/parallel.h"
#include "snell/kernel/light.h"
#include "snell/kernel/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace snell {

namespace {
constexpr std::size_t batch_size = 4096;
constexpr std::size_t shuffled_tile = 1024;
constexpr std::size_t tile_side = 8;

// A point of a surface, and the normal on the side that the ray came from.
struct Start
{
    vec3 position, normal;
};

// What each number is drawn for; the sets must not share any.
enum class Purpose : uint
{
    pixel,
    light,
    occlusion,
    bounce,
    shuffle = bounce + 8
};
} // namespace

// Three independent numbers in [0, 1).
static vec3 draw(const RaySetOptions& options, Purpose purpose, uint set, std::size_t index)
{
    const uvec3 word = pcg3d(uvec3(static_cast<uint>(index), static_cast<uint>(index >> 32u) * 16u + set,
                                   hash_uint(options.seed) + static_cast<uint>(purpose)));
    return {unit_float(word.x), unit_float(word.y), unit_float(word.z)};
}

int ray_set_side(std::size_t rays)
{
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(rays)));
    return static_cast<int>(std::clamp(side / tile_side, std::size_t{1}, std::size_t{1} << 12) * tile_side);
}

static std::vector<Ray> camera_rays(const Camera& camera, const RaySetOptions& options)
{
    const auto side = static_cast<std::size_t>(ray_set_side(options.rays)), tiles = side / tile_side;
    std::vector<Ray> rays(side * side);
    parallel_ranges(rays.size(), batch_size, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t tile = i / (tile_side * tile_side), within = i % (tile_side * tile_side);
            const auto x = static_cast<float>(tile % tiles * tile_side + within % tile_side);
            const auto y = static_cast<float>(tile / tiles * tile_side + within / tile_side);
            const vec3 jitter = draw(options, Purpose::pixel, 0, i);
            rays[i] = camera_ray(camera, vec2(x + jitter.x, y + jitter.y));
        }
    });
    return rays;
}

// Where the rays meet surfaces, in their order; those that miss have no entry.
static std::vector<Start> find_starts(const SceneView& view, const Accel& accel, const std::vector<Ray>& rays)
{
    std::vector<Start> all(rays.size());
    std::vector<std::uint8_t> ok(rays.size(), 0);
    const std::size_t batches = (rays.size() + batch_size - 1) / batch_size;
    parallel_for(batches, [&](std::size_t batch) {
        const std::size_t first = batch * batch_size, count = std::min(batch_size, rays.size() - first);
        std::vector<Hit> hits(count);
        accel.intersect(std::span(rays).subspan(first, count), hits);
        for (std::size_t i = 0; i < count; ++i) {
            if (!is_hit(hits[i])) continue;
            const Ray& ray = rays[first + i];
            const SurfacePoint point = surface_point(view, ray, hits[i]);
            const vec3 n = point.geometric_normal;
            if (!is_finite3(point.position) || !is_finite3(n)) continue;
            all[first + i] = {point.position, dot(n, ray.direction) > 0.0f ? -n : n};
            ok[first + i] = 1;
        }
    });
    std::vector<Start> starts;
    starts.reserve(static_cast<std::size_t>(std::count(ok.begin(), ok.end(), 1)));
    for (std::size_t i = 0; i < all.size(); ++i)
        if (ok[i] != 0) starts.push_back(all[i]);
    return starts;
}

// Ray i of `count` starts at the same place of the list, relatively: so neighbours stay neighbours.
static const Start& start_of(const std::vector<Start>& starts, std::size_t i, std::size_t count)
{
    return starts[i * starts.size() / count];
}

static std::vector<Ray> cosine_rays(const std::vector<Start>& starts, const RaySetOptions& options, Purpose purpose,
                                    uint set, float length_limit)
{
    std::vector<Ray> rays(starts.empty() ? 0 : options.rays);
    parallel_ranges(rays.size(), batch_size, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Start& start = start_of(starts, i, rays.size());
            const vec3 u = draw(options, purpose, set, i);
            const vec3 direction = to_world(make_frame(start.normal), sample_cosine_hemisphere(vec2(u.x, u.y)));
            rays[i] = make_ray(offset_point(start.position, start.normal), direction, length_limit);
        }
    });
    return rays;
}

static void shuffle_tiles(std::vector<Ray>& rays, const RaySetOptions& options, uint set)
{
    parallel_for((rays.size() + shuffled_tile - 1) / shuffled_tile, [&](std::size_t tile) {
        const std::size_t first = tile * shuffled_tile, count = std::min(shuffled_tile, rays.size() - first);
        for (std::size_t i = count; i-- > 1;) {
            const float u = draw(options, Purpose::shuffle, set, first + i).x;
            std::swap(rays[first + i], rays[first + std::min(i, static_cast<std::size_t>(u * float(i + 1)))]);
        }
    });
}

// For scenes without lights: a horizontal square just below the top.
static std::pair<vec3, float> stand_in_light(const PackedScene& scene)
{
    vec3 lower(infinity()), upper(-infinity());
    const PackedGroup& world = scene.world;
    for (uint i = world.first_triangle; i < world.first_triangle + world.triangle_count; ++i) {
        const Triangle& t = scene.triangles[i];
        for (const uint v : {t.v0, t.v1, t.v2}) {
            if (!is_finite3(scene.positions[v])) continue;
            lower = min(lower, scene.positions[v]);
            upper = max(upper, scene.positions[v]);
        }
    }
    if (!(lower.x <= upper.x)) lower = scene.center - vec3(scene.radius), upper = scene.center + vec3(scene.radius);
    const vec3 extent = upper - lower;
    return {vec3(0.5f * (lower.x + upper.x), upper.y - 0.03f * extent.y, 0.5f * (lower.z + upper.z)),
            0.2f * std::max(extent.x, extent.z)};
}

static std::vector<Ray> shadow_rays(const PackedScene& scene, const SceneView& view, const std::vector<Start>& starts,
                                    const RaySetOptions& options)
{
    const auto [center, side] = stand_in_light(scene);
    std::vector<Ray> rays(starts.empty() ? 0 : options.rays);
    parallel_ranges(rays.size(), batch_size, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Start& start = start_of(starts, i, rays.size());
            rays[i] = make_ray(start.position, start.normal, -1.0f); // no light can reach it, until one is found
            if (view.light_count == 0) {
                const vec3 u = draw(options, Purpose::light, 0, i) - 0.5f;
                const vec3 way = center + side * vec3(u.x, 0.0f, u.y) - start.position;
                rays[i] = make_ray(offset_toward(start.position, start.normal, way), way, 1.0f);
                continue;
            }
            SurfacePoint surface = {};
            surface.position = start.position;
            surface.geometric_normal = start.normal;
            for (uint attempt = 0; attempt < 4; ++attempt) {
                const vec3 u = draw(options, Purpose::light, attempt, i);
                const Light& light = view.lights.at[select_light(view, u.z)];
                const LightSample found = sample_light(light, start.position, vec2(u.x, u.y));
                if (!(found.pdf > 0.0f)) continue;
                rays[i] = shadow_ray(surface, found);
                break;
            }
        }
    });
    // Points behind the lamps.
    std::erase_if(rays, [](const Ray& ray) { return !(ray.t_max > 0.0f) || !is_finite3(ray.direction); });
    return rays;
}

std::vector<RaySet> make_ray_sets(const PackedScene& scene, const Camera& camera, const Accel& accel,
                                  const RaySetOptions& options)
{
    const SceneView view = scene.view();
    std::vector<RaySet> sets;
    sets.push_back({"camera", false, true, camera_rays(camera, options)});
    std::vector<Start> starts = find_starts(view, accel, sets[0].rays);

    const float distance = options.occlusion_distance > 0.0f ? options.occlusion_distance : 0.25f * scene.radius;
    sets.push_back({"shadow", true, true, shadow_rays(scene, view, starts, options)});
    sets.push_back({"ao", true, false, cosine_rays(starts, options, Purpose::occlusion, 0, distance)});
    for (uint bounce = 1; bounce <= 3; ++bounce) {
        if (bounce > 1) starts = find_starts(view, accel, sets.back().rays);
        std::vector<Ray> rays = cosine_rays(starts, options, Purpose::bounce, bounce, infinity());
        shuffle_tiles(rays, options, bounce);
        sets.push_back({"bounce" + std::to_string(bounce), false, false, std::move(rays)});
    }
    return sets;
}

} // namespace snell
