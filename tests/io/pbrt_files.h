// What the tests of the pbrt reader share.
#pragma once

#include "tests/io/mesh_files.h"

#include "snell/io/pbrt/pbrt.h"

namespace snell::test {

// The scene of a text. Files beside it may be written into `folder` before.
inline Scene read_pbrt(const Folder& folder, const std::string& text, const LoadOptions& options = {})
{
    return load_pbrt(folder.write("scene.pbrt", text), options);
}
inline Scene read_pbrt(const std::string& text)
{
    const Folder folder;
    return read_pbrt(folder, text);
}

// The message of the Error; "" if there is none.
inline std::string pbrt_error(const std::string& text)
{
    try {
        read_pbrt(text);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

inline std::size_t warning_count(const Scene& scene)
{
    std::size_t count = 0;
    for (const Note& note : scene.notes) count += note.kind == Note::Kind::warning ? 1 : 0;
    return count;
}

inline std::string all_notes(const Scene& scene)
{
    std::string text;
    for (const Note& note : scene.notes) text += note.text + "\n";
    return text;
}

// A triangle, for scenes that need something with a material.
constexpr const char* a_triangle = R"( Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "point2 uv" [0 0 1 0 0 1] )";

inline void expect_near(vec3 a, vec3 b, float tolerance, const std::string& what = {})
{
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << what << " channel " << c;
}

} // namespace snell::test
