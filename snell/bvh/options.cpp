#include "snell/bvh/options.h"

#include "snell/core/error.h"
#include "snell/core/text.h"

#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <cmath>

namespace snell {

static const std::array<std::string, 8> keys = {
    "builder=auto  how the tree is built: see 'snell list'",
    "build_on=cpu  with --device gpu: cpu (better trees) or gpu (built faster, by clustering: docs/gpu.md)",
    "split_budget=0.25  sbvh: references it may add, as a part of the primitives",
    "reinsertion=0  rounds of reinsertion after building, 0 to 100 (auto does two by itself)",
    "traversal=auto  auto, single, packets or stream",
    "triangle_test=watertight  watertight or moller-trumbore",
    "update=auto  what changes its shape: auto, refit or rebuild",
    "rebuild_factor=1.5  update=auto: rebuild once the tree costs so much more",
};

std::span<const std::string> accel_parameters()
{
    return keys;
}

static std::string_view name_of(const std::string& line)
{
    return std::string_view(line).substr(0, line.find('='));
}

bool is_accel_parameter(std::string_view key)
{
    for (const std::string& line : keys)
        if (name_of(line) == key) return true;
    return false;
}

static double read_number(const std::string& key, const std::string& text, double low, double high)
{
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() || !(value >= low && value <= high))
        throw Error(fmt::format("-D {}={} is no number from {} to {}", key, text, low, high));
    return value;
}

template <class Value, std::size_t count>
static Value read_choice(const std::string& key, const std::string& text,
                         const std::array<std::pair<const char*, Value>, count>& choices)
{
    std::vector<std::string> names;
    for (const auto& [name, value] : choices) {
        if (text == name) return value;
        names.emplace_back(name);
    }
    throw Error(fmt::format("-D {}={} is none of {}", key, text, fmt::join(names, ", ")));
}

AccelOptions read_accel_options(const std::map<std::string, std::string>& parameters, AccelOptions base)
{
    using std::pair;
    for (const auto& [key, text] : parameters) {
        if (key == "builder") {
            base.build.builder = text;
        } else if (key == "build_on") {
            base.build_on_gpu = read_choice(key, text, std::array{pair{"cpu", false}, pair{"gpu", true}});
        } else if (key == "split_budget") {
            base.build.split_budget = read_number(key, text, 0, 4);
        } else if (key == "reinsertion") {
            const double rounds = read_number(key, text, 0, 100);
            if (rounds != std::floor(rounds)) throw Error(fmt::format("-D {}={} is not a whole number", key, text));
            base.build.reinsertion = static_cast<uint>(rounds);
        } else if (key == "traversal") {
            base.traversal =
                read_choice(key, text,
                            std::array{pair{"auto", Traversal::automatic}, pair{"single", Traversal::single},
                                       pair{"packets", Traversal::packets}, pair{"stream", Traversal::stream}});
        } else if (key == "triangle_test") {
            base.triangle_test = read_choice(key, text,
                                             std::array{pair{"watertight", TriangleTest::watertight},
                                                        pair{"moller-trumbore", TriangleTest::moller_trumbore}});
        } else if (key == "update") {
            base.update =
                read_choice(key, text,
                            std::array{pair{"auto", UpdatePolicy::automatic}, pair{"refit", UpdatePolicy::refit},
                                       pair{"rebuild", UpdatePolicy::rebuild}});
        } else if (key == "rebuild_factor") {
            base.rebuild_factor = read_number(key, text, 1, 1e6);
        }
    }
    return base;
}

} // namespace snell
