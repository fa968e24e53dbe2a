#include "snell/render/render.h"

#include "snell/bvh/deferred.h"
#include "snell/bvh/options.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/kernel/views.h"
#include "snell/render/rendering.h"
#include "snell/render/suggestion.h"
#include "snell/scene/lights.h"

#include <algorithm>

namespace snell {

static void forget_textures(Material& material)
{
    material.base_slot = material.emission_slot = material.normal_slot = material.opacity_slot = none;
}

static void forget_textures(Principled& p)
{
    for (uint* slot : {&p.metallic_slot, &p.roughness_slot, &p.specular_slot, &p.specular_color_slot, &p.clearcoat_slot,
                       &p.clearcoat_roughness_slot, &p.clearcoat_normal_slot, &p.sheen_color_slot,
                       &p.sheen_roughness_slot, &p.transmission_slot, &p.anisotropy_slot, &p.iridescence_slot,
                       &p.iridescence_thickness_slot, &p.diffuse_transmission_slot, &p.diffuse_transmission_color_slot})
        *slot = none;
}

static void apply_overrides(PackedScene& packed, const RenderSettings& settings)
{
    if (!settings.image_textures)
        for (Principled& p : packed.principled) forget_textures(p);
    for (Material& material : packed.materials) {
        if (!settings.image_textures) forget_textures(material);
        if (!settings.force_diffuse || material.kind == material_diffuse) continue;
        MaterialPoint point = {};
        point.base_color = material.base_color;
        point.kind = material.kind;
        point.specular = material.specular;
        point.alpha = material.alpha;
        point.k = material.absorption;
        point.ior = material.ior;
        material.base_color = material.kind == material_principled ? material.base_color : material_albedo(point);
        material.kind = material_diffuse;
    }
}

void Prepared::build(const Scene& scene)
{
    const bool on_gpu = settings.device != "cpu";
    const AccelInfo* info = !settings.accel.empty() ? find_accel(settings.accel)
                            : on_gpu                ? find_accel(gpu_accels().front())
                                                    : &accels().front();
    if (info == nullptr)
        throw Error(fmt::format("there is no accelerator '{}'", settings.accel), suggestion(settings.accel, accels()));
    if (on_gpu && !std::ranges::count(gpu_accels(), info->name))
        throw Error("GPUs trace the structures bvh8q and bvh2 only", "choose one of them by --accel, or leave it out");
    if (scene.cameras.empty()) throw Error("the scene has no camera", "call complete() before rendering it");
    set_thread_count(settings.threads);
    const AccelOptions options = read_accel_options(settings.parameters, settings.accel_options);
    if (options.build_on_gpu && !on_gpu)
        throw Error("-D build_on=gpu builds trees on a GPU, and the processor renders",
                    "add --device gpu, or choose one of the builders that 'snell list' shows");

    is_usable_ = false;
    Timer timer;
    device.reset(); // refers to what is replaced
    accel.reset();
    packed = {}; // not two of them at a time
    if (settings.keep_motion && !motion) motion = std::make_unique<MotionMap>();
    packed = settings.keep_motion ? pack(scene, *motion) : pack(scene);
    apply_overrides(packed, settings);
    // An update() will list the lights with the materials that are there then: so do that now as well.
    if (settings.keep_motion && !settings.image_textures) pack_lights(scene, packed);
    camera = scene.cameras.front();
    pack_seconds = timer.lap();
    if (on_gpu) {
        auto on_host = std::make_unique<DeferredAccel>(packed, *info, options);
        const Accel* const built = options.build_on_gpu ? nullptr : &on_host->now();
        device = make_device_scene(settings.device, packed, *info, options, built);
        on_host->stats = built != nullptr ? built->stats : device->tree_stats;
        accel = std::move(on_host);
    } else {
        accel = info->make(packed, options);
    }
    build_seconds = timer.seconds();
    is_usable_ = true;
}

std::unique_ptr<Prepared> prepare(const Scene& scene, const RenderSettings& settings)
{
    auto prepared = std::make_unique<Prepared>();
    prepared->settings = settings;
    prepared->build(scene);
    return prepared;
}

void Prepared::update(const Scene& scene, uint bits)
{
    SNELL_CHECK_EQ(motion != nullptr, true);
    if (scene.cameras.empty()) throw Error("the scene has no camera", "call complete() before rendering it");
    Timer timer;
    set_thread_count(settings.threads);
    if (!is_usable_) bits = change_everything;
    is_usable_ = false;
    const std::optional<PackedChanges> followed =
        follow(scene, packed, *motion, bits, [this](PackedScene& fresh) { apply_overrides(fresh, settings); });
    updated = followed.has_value();
    if (!updated) {
        changes = {};
        build(scene);
        ++builds;
        return;
    }
    changes = *followed;
    camera = scene.cameras.front();
    pack_seconds = timer.lap();
    accel->update(changes);
    if (device) {
        device->update(changes);
        accel->stats = device->tree_stats;
    }
    build_seconds = timer.seconds();
    is_usable_ = true;
}

RenderResult render(const Prepared& prepared, const RenderSettings& settings, const ProgressCallback& progress,
                    const std::atomic<bool>* cancel)
{
    Rendering rendering(prepared, settings, prepared.camera);
    set_thread_count(settings.threads);

    const Timer timer;
    uint done = 0;
    double last_report = 0;
    bool stopped = false;
    const auto report = [&] {
        if (!progress) return;
        Progress p;
        p.stats = rendering.stats();
        p.stats.render_seconds = timer.seconds();
        p.fraction = static_cast<double>(p.stats.samples) / rendering.samples_in_all();
        p.spp_done = done;
        progress(p);
    };
    const auto keep_going = [&] {
        const double now = timer.seconds();
        if (cancel != nullptr && *cancel) stopped = true;
        if (settings.timeout_seconds > 0 && now > settings.timeout_seconds) stopped = true;
        if (now - last_report > 0.1) {
            last_report = now;
            report();
        }
        return !stopped;
    };

    // Passes over the whole picture: when somebody stops the render, all of it has been worked on.
    bool good_enough = false;
    RenderResult result;
    while (done < settings.spp && !stopped && !good_enough) {
        const uint count = std::min(settings.spp - done, std::clamp(done, 8u, 64u));
        try {
            rendering.add_samples(rendering.region(), done, count, keep_going);
        } catch (const DeviceLost& lost) {
            if (rendering.stats().samples == 0) throw;
            result.lost = lost.what();
            stopped = true;
        }
        if (!stopped) done += count;
        good_enough =
            settings.target_error > 0 && rendering.film.estimated_relmse(rendering.region()) <= settings.target_error;
    }

    result.stats = rendering.stats();
    result.stats.pack_seconds = prepared.pack_seconds;
    result.stats.build_seconds = prepared.build_seconds;
    result.stats.updated = prepared.updated;
    result.stats.refitted_trees = prepared.updated ? prepared.accel->stats.refitted : 0;
    result.stats.rebuilt_trees = prepared.updated ? prepared.accel->stats.rebuilt : 0;
    result.stats.render_seconds = timer.seconds();
    result.stats.scene_bytes = prepared.packed.bytes();
    result.stats.accel_bytes = prepared.accel->stats.bytes;
    result.stats.cancelled = stopped;
    report();
    result.film = std::move(rendering.film);
    return result;
}

RenderResult render(const Scene& scene, const RenderSettings& settings)
{
    const std::unique_ptr<Prepared> prepared = prepare(scene, settings);
    return render(*prepared, settings);
}

} // namespace snell
