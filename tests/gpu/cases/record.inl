// What probes note of the vertices of a path.
#ifndef TWIN_CASES
#include "snell/kernel/record.h"
#include "tests/gpu/draw_principled.h"
#else

TWIN(empty_record, 0.0f, 0.0f, 0.0f)
{
    VertexRecord r = empty_record();
    give(r.light_index);
    give(r.bsdf_1.pdf);
    give(r.survival);
    give(r.ending);
}
TWIN(principled_lobe, 0.0f, 0.0f, 1e-4f) // u next to the choice of the lobe
{
    PrincipledPoint p = plain_principled_point(0.5f);
    p.p_coat = 0.2f * unit();
    p.p_sheen = 0.2f * unit();
    p.p_facets = 0.2f * unit();
    p.p_straight = 0.2f * unit();
    p.p_diffuse = 0.2f * unit();
    float u_lobe = unit();
    give(principled_lobe(p, u_lobe));
}
TWIN(scattering_event, 0.0f, 0.0f, 1e-4f) // likewise
{
    uint kind = index_below(material_kinds);
    MaterialPoint m = draw_material_point(kind, 0.5f);
    m.principled = plain_principled_point(0.5f);
    m.principled.p_facets = 0.5f;
    m.principled.p_diffuse = 0.25f;
    vec3 wo = direction();
    BsdfSample s = no_bsdf_sample();
    s.wi = direction();
    s.pdf = range(0.0f, 1.0f);
    s.is_delta = index_below(2u);
    float u_lobe = unit();
    give(scattering_event(m, wo, s, u_lobe));
}

#endif
