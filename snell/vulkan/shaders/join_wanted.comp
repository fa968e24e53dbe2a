#version 460
// Joining clusters: each looks for the neighbour with which it makes the smallest box. `which` 1: it takes the one beside
// it, whatever the box: where surfaces grow along the curve, only one pair a round would agree.
#include "snell/vulkan/shaders/clusters.glsl"

Aabb box_of(uint i)
{
    uint node = cluster_at(i);
    Aabb box;
    box.lower = job.nodes.at[node].lower;
    box.upper = job.nodes.at[node].upper;
    return box;
}

void main()
{
    uint i = item_index();
    uint count = cluster_count();
    if (i >= count) return;
    if (push.which == 1u) {
        job.wanted.at[i] = (i ^ 1u) < count ? i ^ 1u : none;
        return;
    }
    float scale = scale_for(box_of_all());
    Aabb own = box_of(i);
    uint best = none;
    float best_area = 0.0f;
    uint from = i > search_radius ? i - search_radius : 0u;
    uint to = min(i + search_radius, count - 1u);
    for (uint k = from; k <= to; ++k) {
        if (k == i) continue;
        float area = min(half_area(join(own, box_of(k)), scale), 3e38f);
        // An order of pairs that all agree on, so that the first of them is agreed: by area, those of the grid first,
        // which are many at a time where boxes lie on top of each other, and then by place.
        bool better = best == none || area < best_area;
        if (best != none && area == best_area) {
            bool grid = (k ^ i) == 1u;
            bool best_grid = (best ^ i) == 1u;
            better = grid != best_grid ? grid
                                       : min(i, k) < min(i, best) || min(i, k) == min(i, best) && max(i, k) < max(i, best);
        }
        if (better) {
            best = k;
            best_area = area;
        }
    }
    job.wanted.at[i] = best;
}
