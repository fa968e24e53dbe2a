#include "snell/vulkan/spirv.h"

#ifdef SNELL_HAS_SPIRV_OPT
#include <spirv-tools/optimizer.hpp>

#include <unordered_map>
#endif

namespace snell {

#ifdef SNELL_HAS_SPIRV_OPT

std::vector<std::uint32_t> specialised(const std::vector<std::uint32_t>& module,
                                       std::span<const std::uint32_t> constants)
{
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> values;
    for (std::uint32_t i = 0; i < constants.size(); ++i) values[i] = {constants[i]};
    // No more passes than it takes: the optimiser of Debian 12 makes invalid modules of structs that hold addresses in
    // others. What floats are computed stays as it is, for with_no_contraction() has marked it.
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_2);
    optimizer.RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(values))
        .RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
        .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass())
        .RegisterPass(spvtools::CreateLocalSingleStoreElimPass())
        .RegisterPass(spvtools::CreateCCPPass())
        .RegisterPass(spvtools::CreateSimplificationPass())
        .RegisterPass(spvtools::CreateDeadBranchElimPass())
        .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
        .RegisterPass(spvtools::CreateAggressiveDCEPass());
    spvtools::OptimizerOptions options;
    options.set_run_validator(false); // tests do that, with the validation layers
    std::vector<std::uint32_t> result;
    if (!optimizer.Run(module.data(), module.size(), &result, options)) result.clear();
    return result;
}

#else

std::vector<std::uint32_t> specialised(const std::vector<std::uint32_t>&, std::span<const std::uint32_t>)
{
    return {};
}

#endif

} // namespace snell
