#include "snell/cpu/stages.h"

#include "snell/core/timer.h"
#include "snell/kernel/path.h"
#include "snell/kernel/views.h"
#include "snell/kernel/whitted.h"
#include "snell/render/visibility.h"

namespace snell {

void generate_stage(const StageContext& context, Batch& batch, const Region& tile, uint first_sample, uint count)
{
    const Timer timer;
    batch.paths.clear();
    batch.slots.assign(static_cast<std::size_t>((tile.x1 - tile.x0) * (tile.y1 - tile.y0)) * count, SampleSlot{});
    uint slot = 0;
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            for (uint s = 0; s < count; ++s, ++slot) {
                const CameraPath path = generate_camera_path(context.params, static_cast<uint>(x), static_cast<uint>(y),
                                                             first_sample + s, slot);
                if (camera_sees(path.ray))
                    batch.paths.push(path);
                else if (context.params.camera.model != camera_lens) // whose rims are black, not transparent
                    batch.slots[slot].sees_through = 1u;
            }
    batch.stats.camera_rays += slot;
    batch.stats.generate_seconds += timer.seconds();
}

static void intersect_paths(const StageContext& context, Batch& batch, bool from_camera)
{
    intersect_covered(context.scene, context.accel, batch.paths.rays, batch.hits, from_camera,
                      [&](uint i) { return extension_seed(batch.paths.states[i]); });
}

// As intersect_paths for camera rays; steps are counted up to the first surface, with holes or not.
static void intersect_paths_counted(const StageContext& context, Batch& batch)
{
    context.accel.intersect_counted(batch.paths.rays, batch.hits, batch.steps);
    if (context.scene.coverage != 0u) intersect_paths(context, batch, true);
}

static void extend_stage(const StageContext& context, Batch& batch, bool from_camera)
{
    const Timer timer;
    batch.hits.resize(batch.paths.size());
    intersect_paths(context, batch, from_camera);
    batch.stats.extend_seconds += timer.seconds();
}

static void connect_stage(const StageContext& context, Batch& batch)
{
    const Timer timer;
    const ConnectionQueue& queue = batch.connections;
    batch.blocked.resize(queue.size());
    occluded_covered(context.scene, context.accel, queue.rays, batch.blocked,
                     [&](uint i) { return queue.targets[i].seed; });
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const ConnectionQueue::Target& target = queue.targets[i];
        if (!batch.blocked[i]) batch.slots[target.slot].layers[target.layer] += target.value;
    }
    batch.stats.shadow_rays += queue.size();
    batch.stats.connect_seconds += timer.seconds();
}

// The loop that all batched integrators share. shade(state, ray, hit) appends to batch.next and batch.connections.
template <class Shade>
static void run_to_end(const StageContext& context, Batch& batch, const Shade& shade)
{
    bool camera_rays = true;
    while (batch.paths.size() > 0) {
        if (!camera_rays) batch.stats.extension_rays += batch.paths.size();
        extend_stage(context, batch, camera_rays);
        camera_rays = false;
        const Timer timer;
        batch.next.clear();
        batch.connections.clear();
        for (std::size_t i = 0; i < batch.paths.size(); ++i)
            shade(batch.paths.states[i], batch.paths.rays[i], batch.hits[i]);
        batch.stats.shade_seconds += timer.seconds();
        if (batch.connections.size() > 0) connect_stage(context, batch);
        std::swap(batch.paths, batch.next);
    }
}

// Notes for the picture's alpha that a camera ray has left a scene whose environment is hidden.
static void note_escape(const StageContext& context, Batch& batch, const PathState& state, const Hit& hit)
{
    if (is_hit(hit) || state.depth > 0u || context.scene.environment.is_visible != 0u) return;
    if ((context.params.flags & render_furnace) == 0u) batch.slots[state.slot].sees_through = 1u;
}

void run_path(const StageContext& context, Batch& batch)
{
    run_to_end(context, batch, [&](const PathState& state, const Ray& ray, const Hit& hit) {
        const PathStep step = shade_path(context.scene, context.params, state, ray, hit);
        batch.slots[state.slot].layers[step.layer] += step.emitted;
        note_escape(context, batch, state, hit);
        if (step.has_connection != 0u) batch.connections.push(step.connection);
        if (step.has_next != 0u) batch.next.push(step.next);
    });
}

void run_whitted(const StageContext& context, Batch& batch)
{
    run_to_end(context, batch, [&](const PathState& state, const Ray& ray, const Hit& hit) {
        const WhittedStep step = shade_whitted(context.scene, context.params, state, ray, hit);
        batch.slots[state.slot].layers[step.layer] += step.emitted;
        note_escape(context, batch, state, hit);
        for (uint task = 0; task < step.light_tasks; ++task) {
            const Connection c = whitted_connection(context.scene, context.params, step, task);
            if (!is_black(c.value)) batch.connections.push(c);
        }
        if (step.has_next_0 != 0u) batch.next.push(step.next_0);
        if (step.has_next_1 != 0u) batch.next.push(step.next_1);
    });
}

void run_ambient_occlusion(const StageContext& context, Batch& batch)
{
    run_to_end(context, batch, [&](const PathState& state, const Ray& ray, const Hit& hit) {
        if (!is_hit(hit)) {
            batch.slots[state.slot].layers[layer_emission] += vec3(1.0f);
            return;
        }
        const Connection c = ambient_connection(context.scene, context.params, state, ray, hit);
        if (!is_black(c.value)) batch.connections.push(c);
    });
}

void run_view(const StageContext& context, Batch& batch, uint view)
{
    Timer timer;
    const std::size_t count = batch.paths.size();
    batch.hits.resize(count);
    batch.steps.assign(count, 0);
    if (view == view_steps)
        intersect_paths_counted(context, batch);
    else
        intersect_paths(context, batch, true);
    batch.stats.extend_seconds += timer.lap();
    for (std::size_t i = 0; i < count; ++i)
        batch.slots[batch.paths.states[i].slot].layers[layer_emission] =
            view_value(context.scene, context.params, view, batch.paths.rays[i], batch.hits[i], batch.steps[i]);
    batch.stats.shade_seconds += timer.seconds();
}

void run_custom(const StageContext& context, Batch& batch, const RadianceFunction& radiance)
{
    const Timer timer;
    const RayScene scene(context.scene, context.accel);
    for (std::size_t i = 0; i < batch.paths.size(); ++i) {
        const PathState& state = batch.paths.states[i];
        SampleStream stream(state_key(context.params, state));
        batch.slots[state.slot].layers[layer_direct] = radiance(scene, batch.paths.rays[i], stream);
    }
    batch.stats.shade_seconds += timer.seconds();
}

// Puts the path at batch.paths[i] behind its hit if that is a perfect mirror or glass.
static bool follow_delta(const StageContext& context, Batch& batch, std::size_t i, const Hit& hit)
{
    const LookThrough seen =
        look_through(context.scene, context.params, batch.paths.states[i], batch.paths.rays[i], hit);
    if (seen.ok != 0u) batch.next.push(seen.path);
    return seen.ok != 0u;
}

void record_first_hits(const StageContext& context, Batch& batch, const Region& tile, uint first_sample, uint count,
                       Film& film)
{
    FilmLayers& layers = film.layers;
    const int tile_width = tile.x1 - tile.x0;
    const auto film_index = [&](std::size_t slot) {
        const int p = static_cast<int>(slot / count);
        return static_cast<std::size_t>(tile.y0 + p / tile_width) * static_cast<std::size_t>(film.width) +
               static_cast<std::size_t>(tile.x0 + p % tile_width);
    };

    const RenderStats stats_before = batch.stats; // these rays are no part of the render's figures
    generate_stage(context, batch, tile, first_sample, count);
    batch.hits.resize(batch.paths.size());
    batch.steps.resize(batch.paths.size());
    intersect_paths_counted(context, batch);
    // Paths are in the order of their slots; those that are not there the camera does not see.
    for (std::size_t slot = 0, path = 0; slot < batch.slots.size(); ++slot)
        if (path < batch.paths.size() && batch.paths.states[path].slot == slot)
            ++path;
        else
            add_first_hit(layers, film_index(slot), nullptr, 0);
    // What is seen in mirrors comes later than the rest; to add up in the order of samples, keep it by slot first.
    std::vector<vec3> albedo(batch.slots.size(), vec3(0.0f)), normal(batch.slots.size(), vec3(0.0f));
    for (uint bounce = 0; batch.paths.size() > 0; ++bounce) {
        batch.next.clear();
        for (std::size_t i = 0; i < batch.paths.size(); ++i) {
            const std::size_t pixel = film_index(batch.paths.states[i].slot);
            const Hit& hit = batch.hits[i];
            if (!is_hit(hit)) {
                if (bounce == 0) add_first_hit(layers, pixel, nullptr, batch.steps[i]);
                continue;
            }
            const FirstHit first = first_hit(context.scene, batch.paths.rays[i], hit);
            if (bounce == 0) add_first_hit(layers, pixel, &first, batch.steps[i]);
            if (bounce < look_through_bounces && follow_delta(context, batch, i, hit)) continue;
            albedo[batch.paths.states[i].slot] = first.albedo;
            normal[batch.paths.states[i].slot] = first.normal;
        }
        std::swap(batch.paths, batch.next);
        batch.hits.resize(batch.paths.size());
        intersect_paths(context, batch, false);
    }
    for (std::size_t slot = 0; slot < albedo.size(); ++slot)
        add_seen(layers, film_index(slot), albedo[slot], normal[slot]);
    batch.stats = stats_before;
}

} // namespace snell
