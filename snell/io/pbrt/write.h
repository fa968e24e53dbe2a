// Writing pbrt files.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace snell {

struct WriteOptions
{
    bool overwrite = false; // also a file that write_pbrt() did not write
};

// Throws the Errors of write_pbrt() that have to do with the file, not the scene: for asking before a scene is loaded.
void check_pbrt_output(const std::filesystem::path& file, const WriteOptions& options = {});

// Writes a scene, which has passed validate(), as text in the format of pbrt-v4, from which load_scene() makes the same
// one: every number comes back to the bit. What pbrt has words for is written in them; the rest in our own ones
// (docs/pbrt.md), at which pbrt stops, and names in a way that it passes over. Larger meshes go to binary PLY files in
// the folder "NAME_meshes" beside NAME.pbrt, pictures to "NAME_textures" as PNG (8 bits) or EXR (floats): these folders
// count as ours, and files in them are replaced. All files are written atomically, NAME.pbrt as the last one.
//
// Not kept, because the format has no place for it: animations and variants (what is written is the pose at hand), what
// nothing uses, the parameters that a material's kind does not look at, names that are empty or not unique. A mesh of
// several materials becomes one for each; a group that is placed once becomes its shapes, each placed by itself. What
// was left out or changed is said by the result.
// Throws Error before anything is written if the file or the folders cannot be written, if the name does not end in
// .pbrt, or if there is a file of that name that write_pbrt() has not written (unless overwrite).
std::vector<Note> write_pbrt(const Scene& scene, const std::filesystem::path& file, const WriteOptions& options = {});

// What write_pbrt() would put into its file, or what of it is about one thing, for the clipboard. Texels and large
// meshes stay out: the text has the names of files that nobody writes. So does not look at texels, and the images of an
// outline() will do.
std::string pbrt_text(const Scene& scene);
std::string pbrt_text(const Scene& scene, Index<MaterialDesc> material);
std::string pbrt_text(const Scene& scene, const EnvironmentDesc& environment);
std::string pbrt_text(const LightDesc& light);
std::string pbrt_text(const CameraDesc& camera);

} // namespace snell
