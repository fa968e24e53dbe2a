#include "snell/io/gltf/primitive.h"

#include "snell/core/parallel.h"
#include "snell/io/gltf/draco.h"

#include <algorithm>
#include <atomic>
#include <optional>

namespace snell::gltf {
namespace {

constexpr std::size_t grain = 1 << 16;

// What the integers of a normalised accessor are divided by.
float divisor_of(const tinygltf::Accessor& accessor)
{
    if (!accessor.normalized) return 1.0f;
    switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return 127.0f;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 255.0f;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return 32767.0f;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 65535.0f;
    default:
        return 1.0f;
    }
}

class Reader
{
  public:
    Reader(const Document& document, const Buffers& buffers, const Accessors& accessors, Budget& budget,
           std::size_t mesh, std::size_t number)
        : accessors_(accessors), budget_(budget), source_(document.model.meshes[mesh].primitives[number]),
          who_(label("mesh", mesh, document.model.meshes[mesh].name) + fmt::format(", primitive {}", number)),
          draco_fields_(source_.extensions, "KHR_draco_mesh_compression")
    {
        if (draco_fields_.exists() && is_packed()) {
            const std::string_view packed = buffers.view(draco_fields_.integer("bufferView", -1), who_);
            draco_.emplace(packed, budget, who_);
        }
    }

    Primitive read(bool is_skinned)
    {
        const int position = attribute("POSITION");
        if (source_.mode < TINYGLTF_MODE_TRIANGLES) {
            out_.remarks.warn("mode", fmt::format("{}: points and lines are not drawn", who_));
            return std::move(out_);
        }
        if (source_.mode > TINYGLTF_MODE_TRIANGLE_FAN)
            throw Error(fmt::format("{}: mode {} is not known", who_, source_.mode), "write the file again");
        if (position < 0) {
            out_.remarks.warn("position", fmt::format("{} has no positions and is not drawn", who_));
            return std::move(out_);
        }
        vertices_ = draco_ ? draco_->vertex_count() : accessors_.count(position, who_);
        read_triangles();
        if (out_.mesh.triangles.empty()) {
            out_.remarks.warn("empty", fmt::format("{} has no triangles", who_));
            return std::move(out_);
        }
        read_attributes();
        read_targets();
        if (is_skinned) read_skin();
        return std::move(out_);
    }

  private:
    int attribute(const char* name) const
    {
        const auto it = source_.attributes.find(name);
        return it == source_.attributes.end() ? -1 : it->second;
    }

    // Whether there is an accessor whose data is nowhere but in Draco's: else the plain data is there, too.
    bool is_packed() const
    {
        for (const auto& [name, index] : source_.attributes)
            if (accessors_.info(index, who_).bufferView < 0 && packed_attribute(name.c_str()) >= 0) return true;
        return false;
    }
    int packed_attribute(const char* name) const { return draco_fields_.object("attributes").integer(name, -1); }

    // Calls from_draco(number, divisor) or from_accessor(index) for an attribute that is there.
    template <class Vector, class FromDraco, class FromAccessor>
    std::vector<Vector> read_attribute(const char* name, const FromDraco& from_draco, const FromAccessor& from_accessor)
    {
        const int index = attribute(name);
        if (index < 0) return {};
        const std::string who = fmt::format("{}, {}", who_, name);
        const tinygltf::Accessor& accessor = accessors_.info(index, who);
        if (draco_ && packed_attribute(name) >= 0) return from_draco(packed_attribute(name), divisor_of(accessor));
        if (accessor.count != vertices_)
            throw Error(fmt::format("{} has {} elements for {} vertices", who, accessor.count, vertices_),
                        "write the file again");
        return from_accessor(index, who);
    }
    std::vector<vec2> vec2s(const char* name)
    {
        return read_attribute<vec2>(
            name, [&](int id, float divisor) { return draco_->vec2s(id, divisor); },
            [&](int index, const std::string& who) { return accessors_.vec2s(index, who, used_); });
    }
    std::vector<vec3> vec3s(const char* name)
    {
        return read_attribute<vec3>(
            name, [&](int id, float divisor) { return draco_->vec3s(id, divisor); },
            [&](int index, const std::string& who) { return accessors_.vec3s(index, who, used_); });
    }
    std::vector<vec4> vec4s(const char* name)
    {
        return read_attribute<vec4>(
            name, [&](int id, float divisor) { return draco_->vec4s(id, divisor); },
            [&](int index, const std::string& who) { return accessors_.vec4s(index, who, used_); });
    }
    std::vector<vec4> colors(const char* name)
    {
        return read_attribute<vec4>(
            name, [&](int id, float divisor) { return draco_->colors(id, divisor); },
            [&](int index, const std::string& who) { return accessors_.colors(index, who, used_); });
    }
    std::vector<uvec4> joints(const char* name)
    {
        return read_attribute<uvec4>(
            name, [&](int id, float) { return draco_->joints(id); },
            [&](int index, const std::string& who) { return accessors_.joints(index, who, used_); });
    }

    void read_triangles()
    {
        std::vector<uvec3>& triangles = out_.mesh.triangles;
        if (draco_) {
            triangles = draco_->triangles();
            check_range(triangles);
            return;
        }
        const bool is_indexed = source_.indices >= 0;
        const std::string who = who_ + ", indices";
        const std::size_t corners = is_indexed ? accessors_.count(source_.indices, who) : vertices_;
        if (source_.mode == TINYGLTF_MODE_TRIANGLES) {
            if (corners % 3 != 0)
                out_.remarks.warn("corners", fmt::format("{} has {} corners, which is no multiple of 3; the last are "
                                                         "left out",
                                                         who_, corners));
            if (is_indexed) {
                triangles = accessors_.triangles(source_.indices, who);
            } else {
                budget_.charge(corners / 3, sizeof(uvec3), who_ + ": ");
                triangles.resize(corners / 3);
                for (uint i = 0; i < triangles.size(); ++i) triangles[i] = uvec3(3 * i, 3 * i + 1, 3 * i + 2);
            }
        } else if (corners >= 3) {
            std::vector<uint> indices;
            if (is_indexed) indices = accessors_.indices(source_.indices, who);
            const auto corner = [&](std::size_t i) { return is_indexed ? indices[i] : static_cast<uint>(i); };
            budget_.charge(corners, sizeof(uvec3), who_ + ": ");
            triangles.resize(corners - 2);
            const bool is_fan = source_.mode == TINYGLTF_MODE_TRIANGLE_FAN;
            for (std::size_t i = 0; i < triangles.size(); ++i) {
                // In a strip every other triangle runs backwards.
                const std::size_t odd = i % 2;
                triangles[i] = is_fan ? uvec3(corner(i + 1), corner(i + 2), corner(0))
                                      : uvec3(corner(i), corner(i + 1 + odd), corner(i + 2 - odd));
            }
        }
        check_range(triangles);
        // Many primitives may share one large array of vertices: each keeps only its own.
        if (vertices_ > 2 * corners + 1024) keep_used(triangles);
    }

    void check_range(const std::vector<uvec3>& triangles) const
    {
        std::atomic<uint> largest = 0;
        parallel_ranges(triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
            uint here = 0;
            for (std::size_t i = begin; i < end; ++i)
                here = std::max({here, triangles[i].x, triangles[i].y, triangles[i].z});
            for (uint known = largest; known < here && !largest.compare_exchange_weak(known, here);) {
            }
        });
        if (!triangles.empty() && largest >= vertices_)
            throw Error(fmt::format("{}: a triangle refers to vertex {} of {}", who_, largest.load(), vertices_),
                        "write the file again");
    }

    void keep_used(std::vector<uvec3>& triangles)
    {
        used_.reserve(3 * triangles.size());
        for (const uvec3 t : triangles) used_.insert(used_.end(), {t.x, t.y, t.z});
        std::sort(used_.begin(), used_.end());
        used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
        const auto place = [&](uint vertex) {
            return static_cast<uint>(std::lower_bound(used_.begin(), used_.end(), vertex) - used_.begin());
        };
        for (uvec3& t : triangles) t = uvec3(place(t.x), place(t.y), place(t.z));
    }

    void read_attributes()
    {
        Mesh& mesh = out_.mesh;
        mesh.positions = vec3s("POSITION");
        mesh.normals = vec3s("NORMAL");
        // Without normals the tangents mean nothing.
        if (!mesh.normals.empty()) mesh.tangents = vec4s("TANGENT");
        mesh.uvs = vec2s("TEXCOORD_0");
        mesh.uvs_1 = vec2s("TEXCOORD_1");
        mesh.colors = colors("COLOR_0");
        for (std::vector<vec2>* const uvs : {&mesh.uvs, &mesh.uvs_1})
            parallel_ranges(uvs->size(), grain, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) (*uvs)[i].y = 1.0f - (*uvs)[i].y;
            });
        for (const char* const name : {"TEXCOORD_2", "COLOR_1", "JOINTS_2"})
            if (attribute(name) >= 0) out_.remarks.info(name, fmt::format("{} has {}, which is not used", who_, name));
    }

    void read_targets()
    {
        for (std::size_t i = 0; i < source_.targets.size(); ++i) {
            MorphTarget target;
            const auto read = [&](const char* name) -> std::vector<vec3> {
                const auto it = source_.targets[i].find(name);
                if (it == source_.targets[i].end()) return {};
                const std::string who = fmt::format("{}, target {}, {}", who_, i, name);
                if (accessors_.count(it->second, who) != vertices_)
                    throw Error(fmt::format("{} has {} elements for {} vertices", who,
                                            accessors_.count(it->second, who), vertices_),
                                "write the file again");
                return accessors_.vec3s(it->second, who, used_);
            };
            target.positions = read("POSITION");
            if (!out_.mesh.normals.empty()) target.normals = read("NORMAL");
            if (!out_.mesh.tangents.empty()) target.tangents = read("TANGENT");
            out_.targets.push_back(std::move(target));
        }
    }

    void read_skin()
    {
        for (const auto& [joints_name, weights_name] :
             {std::pair{"JOINTS_0", "WEIGHTS_0"}, std::pair{"JOINTS_1", "WEIGHTS_1"}}) {
            const std::vector<uvec4> more_joints = joints(joints_name);
            const std::vector<vec4> more_weights = vec4s(weights_name);
            if (more_joints.empty() || more_weights.empty()) break;
            out_.joints.insert(out_.joints.end(), more_joints.begin(), more_joints.end());
            out_.weights.insert(out_.weights.end(), more_weights.begin(), more_weights.end());
        }
        if (out_.joints.empty())
            out_.remarks.warn("joints", fmt::format("{} hangs on a skin, but has no joints; it stays at rest", who_));
    }

    const Accessors& accessors_;
    Budget& budget_;
    const tinygltf::Primitive& source_;
    std::string who_;
    Fields draco_fields_;
    std::optional<DracoMesh> draco_;
    std::size_t vertices_ = 0;
    std::vector<uint> used_; // vertices that are kept; empty: all
    Primitive out_;
};

} // namespace

Primitive read_primitive(const Document& document, const Buffers& buffers, const Accessors& accessors, Budget& budget,
                         std::size_t mesh, std::size_t number, bool is_skinned)
{
    return Reader(document, buffers, accessors, budget, mesh, number).read(is_skinned);
}

} // namespace snell::gltf
