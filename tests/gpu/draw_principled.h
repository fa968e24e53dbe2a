// Random principled surfaces for cases, in the kernel dialect as draw.h is.
#ifndef SNELL_TESTS_GPU_DRAW_PRINCIPLED_H
#define SNELL_TESTS_GPU_DRAW_PRINCIPLED_H
#include "tests/gpu/draw.h"
SNELL_BEGIN

// A number of [0, 1], often one of the ends.
SNELL_FN_COLD float draw_share()
{
    uint kind = index_below(4u);
    float x = unit();
    if (kind == 0u) return 0.0f;
    return kind == 1u ? 1.0f : x;
}

// Not resolved. The tables are those of the random scene, which has one set for glass.
SNELL_FN_COLD PrincipledPoint draw_principled_point()
{
    float roughness = range(0.08f, 1.0f);
    uint polished = index_below(5u);
    PrincipledPoint p = plain_principled_point(polished == 0u ? 0.0f : roughness * roughness);
    p.base_color = color();
    p.metallic = draw_share();
    uint brushed = index_below(3u);
    p.anisotropy = unit();
    if (brushed != 0u) p.anisotropy = 0.0f;
    p.anisotropy_direction = unit_circle(unit());
    p.ior = range(1.1f, 2.4f);
    p.specular = draw_share();
    p.specular_color = color();
    p.clearcoat = draw_share();
    p.clearcoat_alpha = range(0.01f, 1.0f);
    uint even = index_below(3u);
    if (even == 0u) p.clearcoat_alpha = 0.0f;
    vec3 tilt = 0.3f * direction();
    p.clearcoat_normal = normalize(vec3(tilt.x, tilt.y, 1.0f));
    uint cloth = index_below(2u);
    p.sheen_color = color();
    if (cloth == 0u) p.sheen_color = vec3(0.0f);
    p.sheen_alpha = range(0.05f, 1.0f);
    p.transmission = draw_share();
    p.thin_walled = index_below(2u);
    uint tabulated = index_below(4u);
    p.glass_table = tabulated == 0u ? none : albedo_length;
    p.iridescence = draw_share();
    p.iridescence_ior = range(1.0f, 2.0f);
    p.iridescence_thickness = range(0.0f, 800.0f);
    p.diffuse_transmission = draw_share();
    p.diffuse_transmission_color = color();
    return p;
}

// A wo that is not so grazing that everything cancels.
SNELL_FN_COLD vec3 draw_outgoing()
{
    vec3 w = direction();
    if (abs(w.z) < 0.01f) w = normalize(vec3(w.x, w.y, 0.02f));
    return w;
}

// A material of any kind, resolved for wo.
SNELL_FN_COLD MaterialPoint draw_resolved_point(SNELL_IN(SceneView) scene, uint kind, float alpha, vec3 wo)
{
    MaterialPoint m = draw_material_point(kind, alpha);
    if (kind == material_principled && wo.z != 0.0f)
        m.principled = resolve_principled(scene.albedo, draw_principled_point(), wo);
    return m;
}

SNELL_FN_COLD void give_principled_value(PrincipledValue v)
{
    give(v.f);
    give(v.pdf);
}

// The parameters, as looked up.
SNELL_FN_COLD void give_principled_parameters(SNELL_IN(PrincipledPoint) p)
{
    give(p.base_color);
    give(p.metallic);
    give(p.alpha);
    give(p.anisotropy);
    give(p.anisotropy_direction);
    give(p.ior);
    give(p.specular);
    give(p.specular_color);
    give(p.clearcoat);
    give(p.clearcoat_alpha);
    give(p.clearcoat_normal);
    give(p.sheen_color);
    give(p.sheen_alpha);
    give(p.transmission);
    give(p.thin_walled);
    give(p.glass_table);
    give(p.iridescence);
    give(p.iridescence_ior);
    give(p.iridescence_thickness);
    give(p.diffuse_transmission);
    give(p.diffuse_transmission_color);
}

// What resolve_principled fills.
SNELL_FN_COLD void give_resolved(SNELL_IN(PrincipledPoint) p)
{
    give(p.alphas);
    give(p.reflected_f0);
    give(p.reflected_edge);
    give(p.glass_weight);
    give(p.glass_f0);
    give(p.glass_f90);
    give(p.eta);
    give(p.straight);
    give(p.diffuse);
    give(p.diffuse_through);
    give(p.sheen);
    give(p.coat);
    give(p.albedo);
    give(p.p_coat);
    give(p.p_sheen);
    give(p.p_facets);
    give(p.p_straight);
    give(p.p_diffuse);
    give(p.p_through);
}

SNELL_END
#endif
