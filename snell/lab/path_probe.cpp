#define SNELL_RECORD // the shade stages note what they find: see snell/kernel/record.h
#include "snell/lab/path_probe.h"

#include "snell/core/error.h"
#include "snell/kernel/views.h"
#include "snell/kernel/whitted.h"
#include "snell/render/backend.h"
#include "snell/render/integrator.h"
#include "snell/render/params.h"
#include "snell/render/visibility.h"

namespace snell {
namespace {

// Carries one sample through the stages, as snell/cpu/stages.cpp carries batches of them.
class Replay
{
  public:
    Replay(const Prepared& from, const RenderParams& of_render, ProbedPath& result)
        : prepared(from), view(from.packed.view()), params(of_render), path(result)
    {
    }

    void begin()
    {
        const CameraPath start =
            generate_camera_path(params, static_cast<uint>(path.x), static_cast<uint>(path.y), path.sample, 0);
        waiting.push_back({start, -1, 0});
        const SampleKey key = state_key(params, start.state);
        const vec2 jitter = (params.flags & render_jitter) != 0u ? random_2d(key, 0u) : vec2(0.5f);
        path.film_position = vec2(static_cast<float>(path.x), static_cast<float>(path.y)) + jitter;
    }

    // shade(vertex, state, ray, hit) appends to `next` and, by connect(), to `connections`; those are tested once all
    // paths of a generation are shaded: contributions are added in that order.
    template <class Shade>
    void run_to_end(const Shade& shade)
    {
        bool from_camera = true;
        while (!waiting.empty()) {
            next.clear();
            connections.clear();
            for (const Waiting& one : waiting) {
                const int vertex = extend(one, from_camera);
                shade(vertex, path.vertices[static_cast<std::size_t>(vertex)].arriving, one.path.ray,
                      path.vertices[static_cast<std::size_t>(vertex)].hit);
            }
            from_camera = false;
            for (const Asked& asked : connections) trace(asked);
            std::swap(waiting, next);
        }
    }

    void run_path()
    {
        run_to_end([&](int vertex, const PathState& state, const Ray& ray, const Hit& hit) {
            VertexRecord record = empty_record();
            const PathStep step = shade_path(view, params, state, ray, hit, record);
            note(vertex, record, step.emitted, step.layer);
            if (record.has_light != 0u) {
                ProbedLight light = probed_light(record);
                if (step.has_connection != 0u) take(light, step.connection);
                connect(vertex, std::move(light), step.connection.seed, step.has_connection != 0u);
            }
            if (record.event_0 != event_none) go_on(vertex, record.event_0, record.bsdf_0, step.next, step.has_next);
        });
    }

    void run_whitted()
    {
        run_to_end([&](int vertex, const PathState& state, const Ray& ray, const Hit& hit) {
            VertexRecord record = empty_record();
            const WhittedStep step = shade_whitted(view, params, state, ray, hit, record);
            note(vertex, record, step.emitted, step.layer);
            for (uint task = 0; task < step.light_tasks; ++task) {
                VertexRecord of_light = empty_record();
                const Connection c = whitted_connection(view, params, step, task, of_light);
                ProbedLight light = probed_light(of_light);
                take(light, c);
                connect(vertex, std::move(light), c.seed, !is_black(c.value));
            }
            if (record.event_0 != event_none)
                go_on(vertex, record.event_0, record.bsdf_0, step.next_0, step.has_next_0);
            if (record.event_1 != event_none)
                go_on(vertex, record.event_1, record.bsdf_1, step.next_1, step.has_next_1);
        });
    }

    void run_ambient_occlusion()
    {
        run_to_end([&](int vertex, const PathState& state, const Ray& ray, const Hit& hit) {
            if (!is_hit(hit)) {
                at(vertex).ending = ending_escaped;
                emit(vertex, vec3(1.0f), layer_emission);
                return;
            }
            describe(vertex, make_vertex(view, ray, hit));
            at(vertex).ending = ending_direct;
            const Connection c = ambient_connection(view, params, state, ray, hit);
            ProbedLight light;
            light.drawn = no_light_sample();
            light.drawn.direction = c.ray.direction;
            light.drawn.pdf = abs(dot(c.ray.direction, at(vertex).surface.shading_normal)) * inv_pi;
            light.drawn.radiance = vec3(1.0f);
            take(light, c);
            connect(vertex, std::move(light), c.seed, !is_black(c.value));
        });
    }

    void run_view(uint which)
    {
        const int vertex = extend(waiting.front(), true);
        ProbedVertex& v = at(vertex);
        if (is_hit(v.hit)) describe(vertex, make_vertex(view, v.ray, v.hit));
        v.ending = is_hit(v.hit) ? ending_direct : ending_escaped;
        emit(vertex, view_value(view, params, which, v.ray, v.hit, v.steps), layer_emission);
    }

    void run_custom(const RadianceFunction& radiance)
    {
        const int vertex = extend(waiting.front(), true);
        ProbedVertex& v = at(vertex);
        if (is_hit(v.hit)) describe(vertex, make_vertex(view, v.ray, v.hit));
        v.ending = is_hit(v.hit) ? ending_direct : ending_escaped;
        SampleStream stream(state_key(params, v.arriving));
        emit(vertex, radiance(RayScene(view, *prepared.accel), v.ray, stream), layer_direct);
    }

    void finish()
    {
        for (const Contribution& one : path.contributions) path.layers[one.layer] += one.value;
        path.radiance = path.layers[layer_emission] + path.layers[layer_direct] + path.layers[layer_indirect];
    }

  private:
    struct Waiting
    {
        CameraPath path;
        int parent;
        std::size_t continuation; // of the parent
    };
    struct Asked // a shadow ray
    {
        int vertex;
        std::size_t light; // of the vertex
        uint seed;
    };

    const Prepared& prepared;
    const SceneView view;
    const RenderParams& params;
    ProbedPath& path;
    std::vector<Waiting> waiting, next;
    std::vector<Asked> connections;

    ProbedVertex& at(int vertex) { return path.vertices[static_cast<std::size_t>(vertex)]; }

    // The end of a ray becomes a vertex.
    int extend(const Waiting& one, bool from_camera)
    {
        const int vertex = static_cast<int>(path.vertices.size());
        ProbedVertex v;
        v.parent = one.parent;
        v.ray = one.path.ray;
        v.arriving = one.path.state;
        v.throughput = one.path.state.throughput;
        Hit first;
        prepared.accel->intersect_counted({&v.ray, 1}, {&first, 1}, {&v.steps, 1});
        intersect_covered(view, *prepared.accel, {&v.ray, 1}, {&v.hit, 1}, from_camera,
                          [&](uint) { return extension_seed(v.arriving); });
        v.passed_holes = is_hit(first) &&
                         (first.primitive != v.hit.primitive || first.instance != v.hit.instance || first.t != v.hit.t);
        if (one.parent >= 0) at(one.parent).continuations[one.continuation].vertex = vertex;
        path.vertices.push_back(std::move(v));
        return vertex;
    }

    void describe(int vertex, const Vertex& found)
    {
        ProbedVertex& v = at(vertex);
        v.is_surface = true;
        v.surface = found.surface;
        v.material_kind = found.material.kind;
        v.alpha = found.material.kind == material_principled ? found.material.principled.alpha : found.material.alpha;
    }

    void emit(int vertex, vec3 value, uint layer)
    {
        at(vertex).emitted = value;
        at(vertex).layer = layer;
        path.contributions.push_back({vertex, -1, layer, value});
    }

    void note(int vertex, const VertexRecord& record, vec3 emitted, uint layer)
    {
        if (record.has_vertex != 0u) describe(vertex, record.vertex);
        ProbedVertex& v = at(vertex);
        v.throughput = record.state.throughput;
        v.emission = record.emission;
        v.emission_pdf = record.emission_pdf;
        v.emission_weight = record.emission_weight;
        v.survival = record.survival;
        v.ending = record.ending;
        emit(vertex, emitted, layer);
    }

    static ProbedLight probed_light(const VertexRecord& record)
    {
        ProbedLight light;
        light.light = record.light_index;
        light.drawn = record.light;
        light.bsdf = record.light_bsdf;
        light.bsdf_pdf = record.light_bsdf_pdf;
        light.weight = record.light_weight;
        return light;
    }

    static void take(ProbedLight& light, const Connection& connection)
    {
        light.ray = connection.ray;
        light.value = connection.value;
        light.layer = connection.layer;
    }

    void connect(int vertex, ProbedLight light, uint seed, bool is_traced)
    {
        light.was_traced = is_traced;
        if (is_traced) connections.push_back({vertex, at(vertex).lights.size(), seed});
        at(vertex).lights.push_back(std::move(light));
    }

    void trace(const Asked& asked)
    {
        ProbedLight& light = at(asked.vertex).lights[asked.light];
        std::uint8_t blocked = 0;
        occluded_covered(view, *prepared.accel, {&light.ray, 1}, {&blocked, 1}, [&](uint) { return asked.seed; });
        light.is_blocked = blocked != 0;
        if (light.is_blocked) {
            Hit hit;
            intersect_covered(view, *prepared.accel, {&light.ray, 1}, {&hit, 1}, false,
                              [&](uint) { return asked.seed; });
            light.blocked_at = hit.t * length(light.ray.direction);
        } else {
            path.contributions.push_back({asked.vertex, static_cast<int>(asked.light), light.layer, light.value});
        }
    }

    void go_on(int vertex, uint event, const BsdfSample& drawn, const CameraPath& onward, uint has_next)
    {
        ProbedVertex::Continuation c;
        c.event = event;
        c.pdf = drawn.pdf;
        c.weight = drawn.weight;
        if (has_next != 0u) {
            c.direction = onward.ray.direction;
            c.throughput = onward.state.throughput;
            next.push_back({onward, vertex, at(vertex).continuations.size()});
        }
        at(vertex).continuations.push_back(c);
    }
};

} // namespace

static const IntegratorInfo& checked_integrator(const RenderSettings& settings, int x, int y)
{
    const IntegratorInfo* integrator = find_integrator(settings.integrator);
    if (integrator == nullptr)
        throw Error(fmt::format("there is no integrator '{}'", settings.integrator), "`snell list` names them");
    if (x < 0 || y < 0 || x >= settings.width || y >= settings.height)
        throw Error(fmt::format("pixel {},{} is not inside the {}x{} picture", x, y, settings.width, settings.height));
    return *integrator;
}

ProbedPath probe_path(const Prepared& prepared, const CameraDesc& camera, const RenderSettings& settings, int x, int y,
                      uint sample)
{
    const IntegratorInfo* integrator = &checked_integrator(settings, x, y);
    const ReadyParams params = make_render_params(settings, *integrator, camera, prepared.packed.radius);
    ProbedPath path;
    path.x = x;
    path.y = y;
    path.sample = sample;
    Replay replay(prepared, params, path);
    replay.begin();
    if (integrator->radiance)
        replay.run_custom(integrator->radiance);
    else if (integrator->is_view)
        replay.run_view(integrator->view);
    else if (integrator->name == "whitted")
        replay.run_whitted();
    else if (integrator->name == "ao")
        replay.run_ambient_occlusion();
    else
        replay.run_path();
    replay.finish();
    return path;
}

vec3 render_sample(const Prepared& prepared, const CameraDesc& camera, const RenderSettings& settings, int x, int y,
                   uint sample)
{
    const IntegratorInfo& integrator = checked_integrator(settings, x, y);
    RenderSettings one = settings;
    one.layers = false;
    one.strict = false;
    const ReadyParams params = make_render_params(one, integrator, camera, prepared.packed.radius);
    Film film(settings.width, settings.height, false);
    make_cpu_backend({prepared.packed, *prepared.accel, params, one, integrator})
        ->render_samples(Region{x, y, x + 1, y + 1}, sample, 1, film, [] { return true; });
    return film
        .sum[static_cast<std::size_t>(y) * static_cast<std::size_t>(settings.width) + static_cast<std::size_t>(x)];
}

std::string_view event_name(uint event)
{
    switch (event) {
    case event_diffuse_reflection:
        return "diffuse reflection";
    case event_glossy_reflection:
        return "glossy reflection";
    case event_specular_reflection:
        return "specular reflection";
    case event_diffuse_transmission:
        return "diffuse transmission";
    case event_glossy_refraction:
        return "glossy refraction";
    case event_specular_refraction:
        return "specular refraction";
    default:
        return "nothing";
    }
}

std::string_view ending_name(uint ending)
{
    switch (ending) {
    case ending_none:
        return "goes on";
    case ending_escaped:
        return "escaped";
    case ending_depth:
        return "at max_depth";
    case ending_absorbed:
        return "absorbed";
    case ending_leak:
        return "through the surface";
    case ending_roulette:
        return "Russian roulette";
    case ending_faint:
        return "too faint";
    default:
        return "not followed";
    }
}

std::string_view layer_name(uint layer)
{
    return layer == layer_emission ? "emission" : layer == layer_direct ? "direct" : "indirect";
}

std::string_view material_kind_name(uint kind)
{
    static constexpr std::string_view names[] = {"diffuse",   "mirror", "mix",       "dielectric",
                                                 "conductor", "unlit",  "principled"};
    static_assert(std::size(names) == material_kinds);
    return kind < material_kinds ? names[kind] : "unknown";
}

} // namespace snell
