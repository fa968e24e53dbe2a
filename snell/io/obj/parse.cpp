#include "snell/io/obj/parse.h"

#include "snell/core/error.h"
#include "snell/io/obj/line_gate.h"

#include <tiny_obj_loader.h>

#include <cmath>
#include <istream>
#include <limits>

namespace snell::obj {
namespace {

constexpr std::size_t most = std::numeric_limits<int>::max();

// What tinyobjloader's callbacks fill.
struct Collector
{
    Document& document;
    LineGate& gate;
    std::vector<int> face_lines;
    std::size_t small_faces = 0;
    int first_small_face = 0;

    vec3 finite_or_nan(vec3 v) const { return gate.is_finite() ? v : vec3(std::numeric_limits<float>::quiet_NaN()); }

    void add_vertex(vec3 position)
    {
        std::vector<vec3>& colors = document.colors;
        if (gate.has_color() && colors.empty()) colors.assign(document.positions.size(), vec3(1.0f));
        const bool has_colors = gate.has_color() || !colors.empty();
        if (document.positions.size() == most) gate.fail("more than 2147483647 vertices", "split the file");
        document.positions.push_back(finite_or_nan(position));
        if (has_colors) colors.push_back(gate.has_color() ? gate.color() : vec3(1.0f));
    }

    // `index` counts from 1, or back from -1; 0 is none given. Those beyond the end are found later: what they refer to
    // may still come.
    int resolve(int index, std::size_t count, const char* what) const
    {
        if (index >= 0) return index - 1;
        const long long found = static_cast<long long>(count) + index;
        if (found < 0)
            gate.fail(fmt::format("{} {} is referred to, but there are only {} before this line", what, index, count),
                      "mend the line or write the file again");
        return static_cast<int>(found);
    }

    void add_face(const tinyobj::index_t* indices, std::size_t count)
    {
        const std::size_t first = document.corners.size();
        for (std::size_t i = 0; i < count; ++i) {
            if (indices[i].vertex_index == 0)
                gate.fail("vertex 0 is referred to, but vertices count from 1",
                          "mend the line or write the file again");
            document.corners.push_back({resolve(indices[i].vertex_index, document.positions.size(), "vertex"),
                                        resolve(indices[i].texcoord_index, document.uvs.size(), "texture coordinate"),
                                        resolve(indices[i].normal_index, document.normals.size(), "normal")});
        }
        if (count < 3) {
            document.corners.resize(first);
            if (small_faces++ == 0) first_small_face = gate.line();
            return;
        }
        document.faces.push_back({first, static_cast<uint>(count), gate.object(), gate.material(), gate.smoothing()});
        face_lines.push_back(gate.line());
    }

    void check_ranges(const std::string& file) const
    {
        const auto check = [&](int index, std::size_t count, const char* what, std::size_t face) {
            if (index >= 0 && static_cast<std::size_t>(index) >= count)
                throw Error({file, face_lines[face], 0},
                            fmt::format("{} {} is referred to, but the file has {}", what, index + 1, count),
                            "it is truncated or damaged: get or write it again");
        };
        for (std::size_t f = 0; f < document.faces.size(); ++f) {
            const Face& face = document.faces[f];
            for (std::size_t i = face.first; i < face.first + face.count; ++i) {
                check(document.corners[i].position, document.positions.size(), "vertex", f);
                check(document.corners[i].uv, document.uvs.size(), "texture coordinate", f);
                check(document.corners[i].normal, document.normals.size(), "normal", f);
            }
        }
    }
};

Collector& collector(void* user)
{
    return *static_cast<Collector*>(user);
}

} // namespace

Document parse(const std::string& file, std::string text)
{
    Document document;
    LineGate gate(file, text, document);
    Collector collected{document, gate, {}, 0, 0};

    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* user, float x, float y, float z, float) {
        collector(user).add_vertex(vec3(x, y, z));
    };
    callbacks.normal_cb = [](void* user, float x, float y, float z) {
        Collector& c = collector(user);
        c.document.normals.push_back(c.finite_or_nan(vec3(x, y, z)));
    };
    callbacks.texcoord_cb = [](void* user, float x, float y, float) {
        Collector& c = collector(user);
        c.document.uvs.push_back(c.gate.is_finite() && std::isfinite(x) && std::isfinite(y) ? vec2(x, y) : vec2(0.0f));
    };
    callbacks.index_cb = [](void* user, tinyobj::index_t* indices, int count) {
        collector(user).add_face(indices, static_cast<std::size_t>(count));
    };

    std::istream stream(&gate);
    stream.exceptions(std::ios::badbit); // an Error thrown by the gate goes through the stream
    tinyobj::LoadObjWithCallback(stream, callbacks, &collected);

    collected.check_ranges(file);
    gate.report();
    if (collected.small_faces > 0)
        document.warnings.push_back(fmt::format("{}:{}: {} faces have less than three corners and are dropped", file,
                                                collected.first_small_face, collected.small_faces));
    return document;
}

} // namespace snell::obj
