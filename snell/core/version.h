// Which snell this is: what bug reports and picture files say.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace snell {

// Such as "0.1.0".
std::string_view version();

// Abbreviated hash of the commit that was built, with "-modified" after it if the sources were not those of the commit;
// "unknown" outside a git clone.
std::string_view commit();

// Name and version of the compiler, such as "GCC 12.2.0".
std::string compiler();

// The instruction sets for which this program has code and that this machine can run, best first, as Highway names
// them: "AVX2", "SSE4", ...
std::vector<std::string> instruction_sets();

} // namespace snell
