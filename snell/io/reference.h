// References from one file to another: a texture, a material library, an included scene.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>
#include <set>
#include <string>

namespace snell {

// Resolves what the files of one scene refer to. A reference is relative to the folder of the scene; '\' counts as '/'
// where no such file is found. An absolute one, or one that climbs out of the scene's folder, is followed and noted,
// once each; with `sandbox` it is an Error. Of an absolute one that does not exist, a file of that name beside the
// scene is taken, and noted. Links count as what they lead to; '%' is a character like any other. Nothing is fetched
// from a network: a reference with a scheme ("http://...") is an Error.
class References
{
  public:
    // scene_file: the file that was opened; everything in its folder and below is inside.
    References(const std::filesystem::path& scene_file, bool sandbox, Scene& scene);

    // The file that `reference` means, seen from a file in `folder` (by default the scene's). It need not exist. place:
    // "file:line: " or so, for the note and the error.
    std::filesystem::path resolve(const std::string& reference, const std::string& place,
                                  const std::filesystem::path& folder = {});

  private:
    std::filesystem::path folder_, root_; // the scene's: as it was given, and without links, "." and ".."
    bool sandbox_;
    Scene& scene_;
    std::set<std::string> noted_;
};

} // namespace snell
