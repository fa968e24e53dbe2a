// Traversal of wide trees with SIMD instructions.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/bvh/wide.h"

namespace snell {

template <class Node>
struct TraceInput
{
    const WideBvh<Node>* bvh = nullptr;
    const PackedScene* scene = nullptr;
    TriangleTest triangle_test = TriangleTest::watertight;
    bool prefetch = false; // fetch nodes early; pays once the tree outgrows the second-level cache
};

// Measured: rays in a room that hit its walls, of 2 to 2.4 nodes each, are 30 to 40% faster in packets, those of 3.8
// nodes equally fast, others slower.
inline constexpr std::size_t few_visits = 3;

// The traversals of one kind of node; all of them give the same answers.
template <class Node>
struct TraceKernels
{
    using Input = const TraceInput<Node>&;
    using Closest = void (*)(Input, std::span<const Ray>, std::span<Hit>);
    using Any = void (*)(Input, std::span<const Ray>, std::span<uint> blockers); // as Accel::find_blockers

    // One ray after the other.
    Closest single;
    Any single_any;
    // The nearest hits behind `after`, in the order of is_later_hit; the rays' t_min are just below its t.
    void (*next)(Input, std::span<const Ray>, std::span<const Hit> after, std::span<Hit>);
    void (*counted)(Input, std::span<const Ray>, std::span<Hit>, std::span<uint> steps);
    // Several rays in flight: while one waits for memory, others go on. For batches. Watertight; else one by one.
    // Returns how many rays are done, from the first on: all, unless the first `probe` (0: do not look) have visited no
    // more than few_visits inner nodes each; then `packets` is faster for the rest, whichever way they go.
    std::size_t (*stream)(Input, std::span<const Ray>, std::span<Hit>, std::size_t probe);
    Any stream_any;
    // Up to 64 rays together. For batches whose neighbours go much the same way. Watertight only.
    Closest packets;
    Any packets_any;
};

// Those for the widest SIMD instructions that the processor has, found out at run time.
template <class Node>
TraceKernels<Node> trace_kernels();
template <>
TraceKernels<Node2> trace_kernels();
template <>
TraceKernels<Node4> trace_kernels();
template <>
TraceKernels<Node8> trace_kernels();
template <>
TraceKernels<QuantisedNode> trace_kernels();

// The instruction sets that this build can choose from on this processor, as Highway's target bits. For tests and
// reports; hwy::SetSupportedTargetsForTest() takes one.
std::vector<std::int64_t> traversal_targets();

} // namespace snell
