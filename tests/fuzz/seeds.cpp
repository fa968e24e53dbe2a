#include "seeds.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace fs = std::filesystem;

namespace snell::hostile {

std::vector<Seed> seeds(const Format& format)
{
    std::vector<Seed> all;
    const fs::path folder = fs::path(SNELL_SOURCE_DIR) / "tests/fuzz/corpus" / format.name;
    std::vector<fs::path> files;
    if (fs::exists(folder))
        for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        std::ifstream in(file, std::ios::binary);
        std::ostringstream bytes;
        bytes << in.rdbuf();
        const std::string name = file.filename().string();
        all.push_back({name, bytes.str(), !name.starts_with("broken_")});
    }
    for (const auto& made : {format.is_image ? made_image_seeds(format.name) : made_mesh_seeds(format.name),
                             format.name == "exr" ? made_exr_seeds() : made_gltf_seeds(format.name)})
        all.insert(all.end(), made.begin(), made.end());
    if (all.empty()) throw std::logic_error("no seeds for " + format.name);
    return all;
}

} // namespace snell::hostile
