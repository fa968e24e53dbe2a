// All traversals of one kind of node. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_KERNELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_KERNELS_INL_H
#undef SNELL_BVH_SIMD_KERNELS_INL_H
#else
#define SNELL_BVH_SIMD_KERNELS_INL_H
#endif

#include "snell/bvh/simd/packet-inl.h"
#include "snell/bvh/simd/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

template <class Node>
TraceKernels<Node> all_kernels()
{
    return {single_closest<Node>, single_any<Node>, single_next<Node>,     single_counted<Node>,
            stream_closest<Node>, stream_any<Node>, packets_closest<Node>, packets_any<Node>};
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
