#version 460
// Building a tree: the boxes of the primitives, and that of all. Triangles come first, then spheres; or instances, and
// then the world's tree.
#include "snell/vulkan/shaders/build.glsl"

shared uint group_low[3];
shared uint group_high[3];

Aabb box_of_primitive(uint i)
{
    if (job.instance_count > 0u) {
        Aabb box;
        if (i == job.instance_count) {
            box.lower = job.tree.lower;
            box.upper = job.tree.upper;
            return box;
        }
        Instance placed = job.instances.at[i];
        GpuTree below = job.groups.at[placed.group];
        if (below.root == word_done) return empty_aabb();
        box.lower = below.lower;
        box.upper = below.upper;
        return instance_bounds(placed.to_world, box);
    }
    if (i < job.triangle_count) {
        Triangle tri = job.triangles.at[job.first_triangle + i];
        return triangle_bounds(job.positions.at[tri.v0], job.positions.at[tri.v1], job.positions.at[tri.v2]);
    }
    Sphere ball = job.spheres.at[job.first_sphere + i - job.triangle_count];
    return sphere_bounds(ball.center, ball.radius);
}

void main()
{
    uint lane = gl_LocalInvocationIndex;
    if (lane < 3u) {
        group_low[lane] = 0xffffffffu;
        group_high[lane] = 0u;
    }
    barrier();
    uint i = item_index();
    if (i < job.count) {
        Aabb box = box_of_primitive(i);
        job.boxes.at[i] = box;
        if (!is_empty(box))
            for (int axis = 0; axis < 3; ++axis) {
                atomicMin(group_low[axis], order_of_float(box.lower[axis]));
                atomicMax(group_high[axis], order_of_float(box.upper[axis]));
            }
    }
    barrier();
    if (lane < 3u && group_low[lane] != 0xffffffffu) {
        atomicMin(counters.low[lane], group_low[lane]);
        atomicMax(counters.high[lane], group_high[lane]);
    }
}
