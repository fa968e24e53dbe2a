// Meshes that KHR_draco_mesh_compression has packed.
#pragma once

#include "snell/core/vec.h"
#include "snell/io/gltf/remarks.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace draco {
class Mesh;
class PointAttribute;
} // namespace draco

namespace snell::gltf {

// An unpacked mesh. Attributes are found by the number that glTF's extension gives them.
class DracoMesh
{
  public:
    // Throws Error, beginning with `who`, if the bytes are damaged or claim more than they can hold.
    DracoMesh(std::string_view bytes, Budget& budget, const std::string& who);
    ~DracoMesh();

    std::size_t vertex_count() const;
    std::vector<uvec3> triangles() const;
    // divisor: what integers are divided by; 1 if they are not normalised.
    std::vector<vec2> vec2s(int attribute, float divisor) const;
    std::vector<vec3> vec3s(int attribute, float divisor) const;
    std::vector<vec4> vec4s(int attribute, float divisor) const;
    std::vector<vec4> colors(int attribute, float divisor) const; // of three numbers or four
    std::vector<uvec4> joints(int attribute) const;

  private:
    const draco::PointAttribute& find(int attribute) const;
    template <class Vector, class Number>
    std::vector<Vector> read(int attribute, int components, double divisor, Number fill) const;

    std::unique_ptr<draco::Mesh> mesh_;
    Budget& budget_;
    std::string who_;
};

} // namespace snell::gltf
