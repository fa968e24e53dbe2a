#include "snell/bvh/simd/traverse.h"

// SSE4 (the least that snell runs on), AVX2 and AVX-512 on x86; elsewhere what Highway finds. The AVX-512 dialects
// beyond the first have nothing for us.
#define HWY_DISABLE_PCLMUL_AES
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "snell/bvh/simd/traverse.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "snell/bvh/simd/packet-inl.h"
#include "snell/bvh/simd/traverse-inl.h"

#if HWY_ONCE
namespace snell {

HWY_EXPORT(single_closest);
HWY_EXPORT(single_next);
HWY_EXPORT(single_any);
HWY_EXPORT(single_counted);
HWY_EXPORT(stream_closest);
HWY_EXPORT(stream_any);
HWY_EXPORT(packets_closest);
HWY_EXPORT(packets_any);

void trace_single(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    HWY_DYNAMIC_DISPATCH(single_closest)(input, rays, hits);
}

void trace_single_next(const TraceInput& input, std::span<const Ray> rays, std::span<const Hit> after,
                       std::span<Hit> hits)
{
    HWY_DYNAMIC_DISPATCH(single_next)(input, rays, after, hits);
}

void trace_single_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked)
{
    HWY_DYNAMIC_DISPATCH(single_any)(input, rays, blocked);
}

void trace_counted(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps)
{
    HWY_DYNAMIC_DISPATCH(single_counted)(input, rays, hits, steps);
}

void trace_stream(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    HWY_DYNAMIC_DISPATCH(stream_closest)(input, rays, hits);
}

void trace_stream_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked)
{
    HWY_DYNAMIC_DISPATCH(stream_any)(input, rays, blocked);
}

void trace_packets(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits)
{
    HWY_DYNAMIC_DISPATCH(packets_closest)(input, rays, hits);
}

void trace_packets_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked)
{
    HWY_DYNAMIC_DISPATCH(packets_any)(input, rays, blocked);
}

std::vector<std::int64_t> traversal_targets()
{
    return hwy::SupportedAndGeneratedTargets();
}

} // namespace snell
#endif
