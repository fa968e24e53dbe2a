// How the active pane is rendered: device, integrator, sampler, structures, samples, and the frame governor.
#include "snell/bvh/options.h"
#include "snell/core/error.h"
#include "snell/render/device.h"
#include "snell/render/integrator.h"
#include "snell/view/panel.h"
#include "snell/view/script_values.h"
#include "snell/view/widgets.h"

#include <imgui.h>

#include <algorithm>
#include <charconv>
#include <map>

namespace snell::view {

namespace {
// "name=default  what it does"
struct Parameter
{
    std::string name, otherwise, help;
};

Parameter parse_parameter(const std::string& line)
{
    Parameter parameter;
    const std::size_t equals = line.find('='), gap = std::min(line.find("  ", equals), line.size());
    parameter.name = line.substr(0, equals);
    parameter.otherwise = line.substr(equals + 1, gap - equals - 1);
    parameter.help = gap < line.size() ? line.substr(line.find_first_not_of(' ', gap)) : "";
    return parameter;
}

bool is_switch(const Parameter& parameter)
{
    return parameter.otherwise == "1" && parameter.help.starts_with("0: ");
}

bool draw_parameter(const Parameter& parameter, std::map<std::string, std::string>& values)
{
    const auto found = values.find(parameter.name);
    std::string value = found == values.end() ? parameter.otherwise : found->second;
    const std::string before = value;
    const std::string help = parameter.help + ". -D " + parameter.name;
    int whole = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), whole);
    const bool is_whole = error == std::errc() && end == value.data() + value.size();
    bool is_default_whole = !parameter.otherwise.empty();
    for (const char c : parameter.otherwise) is_default_whole &= c >= '0' && c <= '9';
    if (is_switch(parameter)) {
        bool on = value != "0";
        if (checkbox(parameter.name.c_str(), on, help.c_str())) value = on ? "1" : "0";
    } else if (is_default_whole && is_whole) {
        const int most = parameter.name == "max_depth" ? 32 : 1000;
        if (slider(parameter.name.c_str(), whole, 0, most, help.c_str())) value = std::to_string(whole);
    } else {
        text(parameter.name.c_str(), value, help.c_str(), "automatic");
    }
    if (value == before) return false;
    if (value == parameter.otherwise || value.empty())
        values.erase(parameter.name);
    else
        values[parameter.name] = value;
    return true;
}

class Settings : public Panel
{
  public:
    const char* name() const override { return "Rendering"; }
    const char* help() const override
    {
        return "Device, integrator, sampler, acceleration structure, samples a pixel, governor.";
    }
    bool opens_at_start() const override { return true; }

    void draw(ViewState& state) override
    {
        Pane& pane = state.panes[std::min(state.active_pane, state.panes.size() - 1)];
        RenderSettings& settings = pane.request.settings;
        if (state.panes.size() > 1)
            fact("Pane", fmt::format("{} of {}", state.active_pane + 1, state.panes.size()),
                 "The pane that was clicked last; its settings are these");
        draw_device(settings);
        draw_integrator(settings);
        draw_sampling(settings);
        draw_structure(settings);
        draw_governor(state);
    }

    bool set(ViewState& state, const std::string& name, const std::string& value) override;
    std::optional<std::string> get(ViewState& state, const std::string& name) override;
    // Of one pane's settings; false: there is none of that name.
    static bool set_of(RenderSettings& settings, const std::string& name, const std::string& value);

  private:
    // Looks for GPUs once; that takes a moment.
    static const GpuList& gpus()
    {
        static const GpuList list = list_gpus();
        return list;
    }

    static void use_device(RenderSettings& settings, const std::string& device)
    {
        settings.device = device;
        const auto traced = gpu_accels();
        if (device == "cpu") settings.parameters.erase("build_on");
        if (device != "cpu" && std::find(traced.begin(), traced.end(), settings.accel) == traced.end())
            settings.accel.clear();
    }

    static void draw_device(RenderSettings& settings)
    {
        std::vector<std::string> names = {"cpu"}, summaries = {"the processor"};
        for (const GpuInfo& gpu : gpus().gpus) {
            if (!gpu.refusal.empty()) continue;
            names.push_back(gpu.device);
            summaries.push_back(gpu.title + ", " + gpu.type);
        }
        std::string device = settings.device;
        const std::string help = "What renders. " + gpus().problem;
        if (choose("Device", device, names, help.c_str(), summaries)) use_device(settings, device);
    }

    static void draw_integrator(RenderSettings& settings)
    {
        std::vector<std::string> names, summaries;
        for (const IntegratorInfo& info : integrators()) names.push_back(info.name), summaries.push_back(info.summary);
        const std::string before = settings.integrator;
        const IntegratorInfo* info = find_integrator(settings.integrator);
        const std::string help = info != nullptr ? info->summary : std::string();
        if (choose("Integrator", settings.integrator, names, help.c_str(), summaries)) {
            // What the new one does not know would be an error.
            const IntegratorInfo* next = find_integrator(settings.integrator);
            std::erase_if(settings.parameters, [&](const auto& entry) {
                if (is_accel_parameter(entry.first)) return false;
                for (const std::string& line : next->parameters)
                    if (parse_parameter(line).name == entry.first) return false;
                return true;
            });
            info = next;
        }
        if (info == nullptr) return;
        for (const std::string& line : info->parameters) draw_parameter(parse_parameter(line), settings.parameters);
    }

    static void draw_sampling(RenderSettings& settings)
    {
        static const std::vector<std::string> samplers = {"sobol", "independent"};
        static const std::vector<std::string> summaries = {
            "Owen-scrambled Sobol points: noise falls faster than with independent numbers",
            "independent random numbers (PCG)"};
        choose("Sampler", settings.sampler, samplers, "Where random numbers come from", summaries);
        int spp = static_cast<int>(settings.spp);
        if (slider("Samples", spp, 1, 65536, "Samples a pixel at which a picture is done (spp)", "%d spp", true))
            settings.spp = static_cast<uint>(spp);
        int seed = static_cast<int>(settings.seed & 0x7fffffffu);
        if (slider("Seed", seed, 0, 1000, "Other random numbers: the same picture with other noise"))
            settings.seed = static_cast<uint>(seed);
    }

    static void draw_structure(RenderSettings& settings)
    {
        std::vector<std::string> names, summaries;
        const auto add = [&](const AccelInfo& info) {
            names.emplace_back(info.name), summaries.emplace_back(info.summary);
        };
        if (settings.device == "cpu")
            for (const AccelInfo& info : accels()) add(info);
        else
            for (const std::string_view name : gpu_accels()) add(*find_accel(name));
        std::string accel = settings.accel.empty() ? names[0] : settings.accel;
        if (choose("Structure", accel, names, "What finds the hits of rays: the acceleration structure", summaries))
            settings.accel = accel;
        names.clear(), summaries.clear();
        for (const BuilderInfo& info : builders()) names.emplace_back(info.name), summaries.emplace_back(info.summary);
        const auto found = settings.parameters.find("builder");
        std::string builder = found != settings.parameters.end() ? found->second : "automatic";
        names.insert(names.begin(), "automatic"), summaries.insert(summaries.begin(), "as it suits the scene");
        if (settings.device != "cpu") {
            names.emplace_back("gpu"), summaries.emplace_back("ploc on the GPU: built fastest, not the best");
            if (settings.parameters.contains("build_on")) builder = "gpu";
        }
        if (choose("Builder", builder, names, "The algorithm that builds the tree (BVH)", summaries))
            use_builder(settings, builder);
    }

    static void use_builder(RenderSettings& settings, const std::string& builder)
    {
        settings.parameters.erase("builder");
        settings.parameters.erase("build_on");
        if (builder == "gpu")
            settings.parameters["build_on"] = "gpu";
        else if (builder != "automatic")
            settings.parameters["builder"] = builder;
    }

    static void draw_governor(ViewState& state)
    {
        ImGui::Separator();
        checkbox("Governor", state.governor.enabled,
                 "While things move, leave out resolution, then bounces, to keep the frame time");
        auto target = static_cast<float>(state.governor.target_ms);
        if (state.governor.enabled && slider("Frame time", target, 5.0f, 200.0f,
                                             "What the governor aims at, for a picture of all panes", "%.0f ms"))
            state.governor.target_ms = target;
        if (button(state.is_paused ? "Go on" : "Pause", "Stop refining pictures, or go on. Key P")) state.press("P");
        ImGui::SameLine();
        if (button("Start again", "From the first sample. Key R")) state.press("R");
    }
};

uint parse_count(const std::string& name, const std::string& value, uint least, uint most)
{
    uint number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || end != value.data() + value.size() || number < least || number > most)
        throw Error(fmt::format("{}: '{}' is not a number from {} to {}", name, value, least, most));
    return number;
}

template <class Infos>
void check_known(const std::string& what, const std::string& value, const Infos& infos)
{
    std::string all;
    for (const auto& info : infos) {
        if (info.name == value) return;
        all += (all.empty() ? "" : ", ") + std::string(info.name);
    }
    throw Error(fmt::format("there is no {} '{}'", what, value), "there are: " + all);
}

bool Settings::set(ViewState& state, const std::string& name, const std::string& value)
{
    if (name == "governor") {
        state.governor.enabled = value == "on" || value == "1";
        return true;
    }
    if (name == "target_ms") {
        state.governor.target_ms = parse_count(name, value, 1, 10000);
        return true;
    }
    // Of the active pane, or as in "pane.seed 2:9".
    constexpr std::string_view of_pane = "pane.";
    if (!name.starts_with(of_pane))
        return set_of(state.panes[std::min(state.active_pane, state.panes.size() - 1)].request.settings, name, value);
    std::string rest = value;
    const std::size_t pane = take_pane(state, rest);
    state.wake();
    return set_of(state.panes[pane].request.settings, name.substr(of_pane.size()), rest);
}

bool Settings::set_of(RenderSettings& settings, const std::string& name, const std::string& value)
{
    if (name == "integrator") {
        check_known(name, value, integrators());
        settings.integrator = value;
        std::erase_if(settings.parameters, [](const auto& entry) { return !is_accel_parameter(entry.first); });
    } else if (name == "sampler") {
        if (value != "sobol" && value != "independent")
            throw Error(fmt::format("there is no sampler '{}'", value), "there are: sobol, independent");
        settings.sampler = value;
    } else if (name == "device") {
        if (!is_device_name(value))
            throw Error(fmt::format("there is no device '{}'", value), "there are: cpu, gpu, gpu:N, auto");
        use_device(settings, choose_device(value).device);
    } else if (name == "accel") {
        check_known("structure", value, accels());
        settings.accel = value;
    } else if (name == "builder") {
        if (value == "gpu" && settings.device == "cpu")
            throw Error("the builder 'gpu' needs a GPU that renders", "set device gpu first");
        if (value != "gpu") check_known(name, value, builders());
        use_builder(settings, value);
    } else if (name == "spp") {
        settings.spp = parse_count(name, value, 1, 1u << 30);
    } else if (name == "seed") {
        settings.seed = parse_count(name, value, 0, 0xffffffffu);
    } else if (name.starts_with("D.")) {
        settings.parameters[name.substr(2)] = value;
    } else {
        return false;
    }
    return true;
}

std::optional<std::string> Settings::get(ViewState& state, const std::string& name)
{
    const RenderSettings& settings = state.panes[std::min(state.active_pane, state.panes.size() - 1)].request.settings;
    if (name == "integrator") return settings.integrator;
    if (name == "sampler") return settings.sampler;
    if (name == "accel") return settings.accel;
    if (name == "device") return settings.device;
    if (name == "seed") return std::to_string(settings.seed);
    if (name == "governor") return state.governor.enabled ? "on" : "off";
    if (name == "target_ms") return fmt::format("{}", state.governor.target_ms);
    return std::nullopt;
}
} // namespace

std::unique_ptr<Panel> make_settings_panel()
{
    return std::make_unique<Settings>();
}

} // namespace snell::view
