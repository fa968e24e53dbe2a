// Writing the geometry of a PackedScene where its plan says. All of it compares before it writes, so that the same
// functions fill the arrays for the first time and follow what moves.
#pragma once

#include "snell/scene/pack_plan.h"

namespace snell {

// Gives the arrays of vertices, triangles, surfaces and spheres their sizes.
void size_geometry(const PackPlan& plan, PackedScene& packed);

// What does not depend on the pose: the surfaces of the placement, without lights, texture coordinates and colours.
void fill_surfaces(const Scene& scene, const PackPlan& plan, const MeshPlacement& placement, PackedScene& packed);

struct VertexChanges
{
    bool positions = false, normals = false;
};

// Positions, normals and tangents.
VertexChanges fill_vertices(const Scene& scene, const MeshPlacement& placement, PackedScene& packed);

// The triangles, wound so that their normals are on the side where the vertex normals are; returns whether one has
// changed.
bool fill_triangles(const Scene& scene, const PackPlan& plan, const MeshPlacement& placement, PackedScene& packed);

// Returns whether it has changed.
bool fill_sphere(const Scene& scene, const PackPlan& plan, std::size_t number, PackedScene& packed);

// Writes the maps of one instance; returns whether they have changed.
bool fill_instance(const Scene& scene, const PackPlan& plan, std::size_t number, PackedScene& packed);

// Fills center and radius; empty bounds: with 0 and 1.
void fill_bounds(const Bounds& bounds, PackedScene& packed);

} // namespace snell
