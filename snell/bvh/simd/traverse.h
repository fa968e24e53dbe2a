// Traversal of the wide tree with the widest SIMD instructions that the processor has, found out at run time.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/bvh/wide.h"

namespace snell {

struct TraceInput
{
    const WideBvh* bvh = nullptr;
    const PackedScene* scene = nullptr;
    TriangleTest triangle_test = TriangleTest::watertight;
    bool prefetch = false; // fetch nodes early; pays once the tree outgrows the second-level cache
};

// One ray after the other.
void trace_single(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits);
// The nearest hits behind `after`, in the order of is_later_hit; the rays' t_min are just below its t.
void trace_single_next(const TraceInput& input, std::span<const Ray> rays, std::span<const Hit> after,
                       std::span<Hit> hits);
void trace_single_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked);
void trace_counted(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits, std::span<uint> steps);

// Several rays in flight: while one waits for memory, others go on. For batches; the same answers.
void trace_stream(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits);
void trace_stream_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked);

// Sixteen rays together. For batches whose neighbours go much the same way; the same answers.
void trace_packets(const TraceInput& input, std::span<const Ray> rays, std::span<Hit> hits);
void trace_packets_any(const TraceInput& input, std::span<const Ray> rays, std::span<std::uint8_t> blocked);

// The instruction sets that this build can choose from on this processor, as Highway's target bits. For tests and
// reports; hwy::SetSupportedTargetsForTest() takes one.
std::vector<std::int64_t> traversal_targets();

} // namespace snell
