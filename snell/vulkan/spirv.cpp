#include "snell/vulkan/spirv.h"

#include "snell/core/error.h"

namespace snell {

namespace {
constexpr std::uint32_t op_decorate = 71, op_member_decorate = 72, no_contraction = 42, header_words = 5;
constexpr std::uint32_t op_loop_merge = 246, dont_unroll = 2;

// Operations on floats that have a result; numbers from the SPIR-V specification, 3.49.13.
bool is_float_arithmetic(std::uint32_t op)
{
    return op == 127 || op == 129 || op == 131 || op == 133 || op == 136 || // negate, add, subtract, multiply, divide
           (op >= 140 && op <= 148 && op != 141);                           // remainder, products of vectors, matrices
}
} // namespace

std::vector<std::uint32_t> with_no_contraction(const std::vector<std::uint32_t>& module)
{
    std::vector<std::uint32_t> decorations;
    std::size_t insert_at = 0;
    for (std::size_t i = header_words, length; i < module.size(); i += length) {
        const std::uint32_t op = module[i] & 0xffffu;
        length = module[i] >> 16;
        SNELL_CHECK_LT(0u, length);
        SNELL_CHECK_LE(i + length, module.size());
        if (op == op_decorate || op == op_member_decorate) insert_at = i + length;
        if (is_float_arithmetic(op)) // opcode, type, result
            decorations.insert(decorations.end(), {3u << 16 | op_decorate, module[i + 2], no_contraction});
    }
    SNELL_CHECK_LT(0u, insert_at); // every shader of ours decorates its buffers
    std::vector<std::uint32_t> exact = module;
    exact.insert(exact.begin() + static_cast<std::ptrdiff_t>(insert_at), decorations.begin(), decorations.end());
    return exact;
}

std::vector<std::uint32_t> without_unrolling(const std::vector<std::uint32_t>& module)
{
    std::vector<std::uint32_t> rolled = module;
    for (std::size_t i = header_words, length; i < rolled.size(); i += length) {
        length = rolled[i] >> 16;
        SNELL_CHECK_LT(0u, length);
        SNELL_CHECK_LE(i + length, rolled.size());
        if ((rolled[i] & 0xffffu) == op_loop_merge) rolled[i + 3] = dont_unroll; // opcode, two labels, control
    }
    return rolled;
}

} // namespace snell
